"""Bits of a marker's or joint angle's flag."""

MISSING = 1  # not seen: the value is NaN
STALE = 2  # the frame repeats the one before
JUMP = 4  # away from the motion before and after: masked
