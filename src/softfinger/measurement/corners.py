"""Rows of a load log between which it is straight.

A dense log has many rows on each ramp. Its corners are seen where straight pieces meet, not between
one row and the next.
"""

import numpy as np
from numpy.typing import NDArray

from softfinger.compiled import compiled


@compiled
def find_corners_array(time: NDArray, torque: NDArray, tolerance: float) -> NDArray:
    """Find knots that straight pieces lead through.

    Each piece is as long as some line from its first knot passes near all others: the cone of
    Sklansky and Gonzalez (1980), Pattern Recognition 12, 327.

    Parameters
    ----------
    time, torque
        (knot,) [s], [N m]: the load goes straight from knot to knot.
    tolerance
        [N m] How far a knot may be from the line.

    Returns
    -------
    (corner,) knots, the first and the last among them. Both knots of a jump are corners; a knot
    that is there twice is no jump.

    >>> dense = np.linspace(0.0, 8.0, 81)
    >>> find_corners_array(dense, 4.0 - np.abs(dense - 4.0), 0.004)
    array([ 0, 40, 80])
    """
    corners = [0]
    least, most = -np.inf, np.inf  # slopes from the last corner that pass every knot since
    for k in range(1, time.size):
        begin = corners[-1]
        span = time[k] - time[begin]
        slope = (torque[k] - torque[begin]) / span if span > 0.0 else np.inf
        rise = abs(torque[k] - torque[k - 1])
        if span == 0.0:  # several small jumps at one time are one
            rise = max(rise, abs(torque[k] - torque[begin]))
        jumps = time[k] == time[k - 1] and rise > tolerance
        if k - 1 > begin and (jumps or not least <= slope <= most):
            corners.append(k - 1)
            least, most, begin, span = -np.inf, np.inf, k - 1, time[k] - time[k - 1]
        if jumps:
            corners.append(k)
            least, most = -np.inf, np.inf
        elif span > 0.0:
            least = max(least, (torque[k] - tolerance - torque[begin]) / span)
            most = min(most, (torque[k] + tolerance - torque[begin]) / span)
    if corners[-1] != time.size - 1:
        corners.append(time.size - 1)
    return np.array(corners)
