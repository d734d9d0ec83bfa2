"""What a fitted model leaves: where, when, which shape."""
