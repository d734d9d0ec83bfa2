"""What a fitted model leaves: where, when, and of which shape."""
