"""What recordings are, before any model.

Frames that count, their noise, time bins, changes of load.
"""
