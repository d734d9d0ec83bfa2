"""The centre of a disc by grey moments: a start for its fit.

Each pixel's share of disc light is its light between level and level plus contrast, as they were
when the disc was last seen. A tenth is cut on either side, so that noise off the rim has no weight.
The centre of these shares is within a few hundredths of a pixel of the disc's, wherever in the
window the disc lies, so that mostly one step of Gauss and Newton is left to take.
"""

import math

import numpy as np

from softfinger.compiled import compiled
from softfinger.tracking.disc import CONTRAST, LEVEL, RADIUS, SLOPE_X, SLOPE_Y, SPREAD, X, Y
from softfinger.tracking.normal import find_chord, has_neighbours

_CUT = 0.1  # of the contrast, on either side
_LARGEST_MISMATCH = 0.25  # of the area: with more in the window than the disc, or less, no start
_LONGEST_MOVE = 1.0  # radii from the predicted place


@compiled
def move_to_moments(
    picture: np.ndarray,
    weight: np.ndarray,
    p: np.ndarray,
    margin: float,
    others: np.ndarray,
    own: int,
) -> bool:
    """Move a disc to its grey moments' centre.

    It stays where it is, and the answer is no, where the window contains other discs, or another
    amount of disc light than the disc has.

    Parameters
    ----------
    picture : (row, column, channel)
    weight : (channel,)
        Light = Σ weight · channel.
    p : (8,)
        Parameters of the disc; its centre is overwritten.
    margin : float [px]
        Width of the background in the window, beyond two edge spreads.
    others : (disc, 3) [px]
        Places and reaches of all discs, of which this is `own`.
    """
    x, y, radius = p[X], p[Y], p[RADIUS]
    reach = radius + 2.0 * p[SPREAD] + margin
    if has_neighbours(x, y, reach, others, own):
        return False
    scale = 1.0 / ((1.0 - 2.0 * _CUT) * p[CONTRAST])
    area = sum_x = sum_y = 0.0
    height, breadth = picture.shape[0], picture.shape[1]
    for i in range(max(0, math.ceil(y - reach)), min(height, math.floor(y + reach) + 1)):
        first, end = find_chord(x, i - y, reach, 0, breadth)
        in_row = along = 0.0
        # what is cut below, as light: the level with its shade, and a tenth of the contrast
        floor = p[LEVEL] * (1.0 + p[SLOPE_Y] * (i - y) - p[SLOPE_X] * x) + _CUT * p[CONTRAST]
        climb = p[LEVEL] * p[SLOPE_X]
        for j in range(first, end):
            light = weight[0] * picture[i, j, 0]
            for k in range(1, weight.size):
                light += weight[k] * picture[i, j, k]
            share = min(max((light - floor - climb * j) * scale, 0.0), 1.0)
            in_row += share
            along += share * j
        area += in_row
        sum_x += along
        sum_y += in_row * i
    expected = math.pi * radius * radius
    if abs(area - expected) > _LARGEST_MISMATCH * expected:
        return False
    to_x, to_y = sum_x / area, sum_y / area
    if math.hypot(to_x - x, to_y - y) > _LONGEST_MOVE * radius:
        return False
    p[X], p[Y] = to_x, to_y
    return True
