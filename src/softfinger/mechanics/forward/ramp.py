"""A soft ramp, which stop, play and threshold share."""

import math

from softfinger.compiled import compiled


@compiled
def softplus(x: float, width: float) -> tuple[float, float]:
    """A ramp max(x, 0) over `width`, and slope."""
    ratio = x / width
    if ratio > 0.0:
        tail = math.exp(-ratio)
        return x + width * math.log1p(tail), 1.0 / (1.0 + tail)
    tail = math.exp(ratio)
    return width * math.log1p(tail), tail / (1.0 + tail)
