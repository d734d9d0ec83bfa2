"""An instrument simulator that writes a campaign folder.

It draws a finger, moves it and films it. Only ``source: synthetic`` distinguishes its campaigns
from measured ones.
"""
