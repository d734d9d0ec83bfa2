"""Ramps that a log reads in a few rows.

A row that differs is read as a step (`campaign.load_log`), so a ramp of several rows is a stair,
half a row late. It is straight from row to row instead, and meets the levels before and after where
its nearest rows lead.
"""

from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def straighten_ramps_array(time: Array, torque: Array, change: float) -> tuple[Array, Array]:
    """Replace steps that follow each other one way by lines.

    Parameters
    ----------
    time, torque
        (knot,) [s], [N m]; of two knots at one time the later one is a row.
    change
        Least step of a ramp [N m]; its first and its last have half of that at least.

    Returns
    -------
    time, torque
        (knot,). Of each step the knot before it is at an end of the ramp, or equals the row.

    >>> stair = np.array([0.0, 1, 1, 2, 2, 3, 3, 4]), np.array([0.0, 0, 1, 1, 3, 3, 4, 4])
    >>> straighten_ramps_array(*stair, 0.1)
    (array([0. , 0.5, 1. , 2. , 2. , 2.5, 3. , 4. ]), array([0., 0., 1., 3., 3., 4., 4., 4.]))
    """
    rows = np.flatnonzero(np.append(np.diff(time) > 0.0, True))
    rise = np.diff(torque[rows])
    is_step = (np.diff(rows) > 1) & (np.abs(rise) > 0.5 * change)
    way = np.where(is_step, np.sign(rise), 0.0)
    turns = np.flatnonzero(np.diff(way, prepend=0.0, append=0.0))
    straight = time.copy(), torque.copy()
    for first, end in pairwise(turns):
        least = np.abs(rise[first:end])
        least[[0, -1]] *= 2.0
        if way[first] != 0.0 and end - first > 1 and np.all(least > change):
            row = rows[first : end + 1]
            knots = row[1:] - 1  # that hold the row before
            straight[0][knots], straight[1][knots] = _join_rows(time[row], torque[row])
    return straight


def _join_rows(time: Array, torque: Array) -> tuple[Array, Array]:
    """Knots before rows of a ramp, from level to level.

    It is at either end as steep as within its nearest rows, and at least as the end asks.
    """
    steep = np.diff(torque) / np.diff(time)
    begins = time[1] - (torque[1] - torque[0]) / max(steep[:2], key=abs)
    ends = time[-2] + (torque[-1] - torque[-2]) / max(steep[-2:], key=abs)
    return np.array([begins, *time[2:-1], ends]), np.array([torque[0], *torque[2:]])
