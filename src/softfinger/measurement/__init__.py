"""What recordings are: frames that count, their noise, time bins, changes of load."""
