"""The search for sets of effects, and its false alarms."""
