"""What other recordings would show."""
