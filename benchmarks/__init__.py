"""Speed and accuracy beside rivals, each as a figure of one run."""
