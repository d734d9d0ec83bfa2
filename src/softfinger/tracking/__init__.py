"""Video → marker positions → joint angles, each with its uncertainty."""
