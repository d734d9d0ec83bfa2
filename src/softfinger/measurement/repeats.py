"""Repeated frames, and angles rounded to a step.

A frame whose angles are all exactly those of the frame before gives no information: the camera or
its reader repeated it. Where angles are rounded so coarsely that equal neighbours come by chance,
none counts as repeated; but an angle rounded to a step errs by at least step/√12.
"""

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from softfinger.measurement.decisions import DECISIONS


def find_repeated_frames(angles: xr.Dataset, frames: xr.Dataset) -> NDArray[np.bool_]:
    """Find the used frames that repeat the one before.

    Both are used; the result is (trial, frame).
    """
    angle = angles["joint_angle"].transpose("trial", "joint", "frame").values
    used, present = frames["used"].values, frames["present"].values
    found = np.zeros_like(used)
    for trial in np.flatnonzero(used.any(axis=1)):
        rows = angle[trial, present[trial]][:, used[trial]]
        same = (np.diff(rows, axis=1) == 0.0).all(axis=0)
        found[trial, np.flatnonzero(used[trial])[1:]] = same
    if found.any():
        chance = np.where(present, _expect_equals(angle, used), 1.0)
        found &= (chance.prod(axis=1) < DECISIONS.equal_by_chance)[:, None]
    return found


def _expect_equals(angle: NDArray[np.float64], used: NDArray[np.bool_]) -> NDArray[np.float64]:
    """Chance (trial, joint) that neighbours are equal by rounding.

    Where a joint never moved, the usual one of its other trials; without those, 1.
    """
    chance = np.array(
        [[_expect_equal(row[some]) for row in rows] for rows, some in zip(angle, used, strict=True)]
    )
    for column in chance.T:
        known = column[np.isfinite(column)]
        column[np.isnan(column)] = np.median(known) if known.size else 1.0
    return chance


def _expect_equal(values: NDArray[np.float64]) -> float:
    """Chance that two neighbours (n,) are equal by rounding.

    It follows from the size of their differences, and is NaN where all are equal.
    """
    change = np.abs(np.diff(values))
    change = change[change > 0]
    if not change.size:
        return np.nan
    return float(min(1.0, find_step_array(values) / np.median(change)))


def find_rounding(angles: xr.Dataset, frames: xr.Dataset) -> NDArray[np.float64]:
    """Find the sd (joint,) [rad] of the angles' rounding.

    A step over √12; 0 where none shows.
    """
    angle = angles["joint_angle"].transpose("joint", "trial", "frame").values
    used = frames["used"].values
    steps = [[find_step_array(row[u & np.isfinite(row)]) for row, u in zip(rows, used, strict=True)]
             for rows in angle]  # fmt: skip
    return np.median(steps, axis=1) / np.sqrt(12.0)


def find_step_array(values: NDArray[np.float64]) -> float:
    """Find the step to which values were rounded.

    The values are (n,); it is 0 where no step shows.

    >>> find_step_array(0.5 * np.arange(30) // 1)
    1.0
    """
    distinct = np.unique(np.round(values, 12))
    gaps = np.diff(distinct)
    if len(values) < DECISIONS.least_values or not gaps.size:
        return 0.0
    step = float(gaps.min())
    away = np.abs(gaps / step - np.round(gaps / step))
    return step if away.max() < 1e-3 * max(1.0, gaps.max() / step) and step > 1e-9 else 0.0
