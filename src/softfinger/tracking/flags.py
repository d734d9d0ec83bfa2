"""What a flag of a marker or of a joint angle says, bit by bit."""

MISSING = 1  # not seen: the value is NaN
STALE = 2  # the frame repeats the one before
JUMP = 4  # away from the motion before and after: masked
