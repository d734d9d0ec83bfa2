"""Angles and loads at the end of a sensor's range.

A value at the limit shows only that the true one is beyond. Noise hardly ever gives the same
extreme twice, so an extreme that many frames share, more than lie just below it, is a limit.
Where readings are rounded so coarsely that neighbours are often equal, none is sought.
"""

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from softfinger.measurement.decisions import DECISIONS
from softfinger.measurement.repeats import find_step_array

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]


def find_saturated_frames(angles: xr.Dataset) -> Flags:
    """Find angles (trial, joint, frame) that only bounds are known of.

    A joint's own readings are at a limit, or the load's have been: what moves afterwards depends
    on a load that nobody knows.
    """
    angle = angles["joint_angle"].transpose("trial", "joint", "frame").values
    flag = angles["angle_flag"].transpose("trial", "joint", "frame").values
    seen = np.where(flag == 0, angle, np.nan)
    found = np.stack(
        [find_saturated_array(seen[:, joint]) for joint in range(seen.shape[1])], axis=1
    )
    time, *log = (
        angles[name].transpose("trial", ...).values for name in ("time", "load_time", "load_torque")
    )
    moment, load = _list_rows(*log)
    pulling = np.where(load == 0.0, np.nan, load)  # a load that has gone is at no limit
    since = np.where(find_saturated_array(pulling), moment, np.inf).min(axis=1)
    return found | (time >= since[:, None])[:, None]


def _list_rows(knot: Array, torque: Array) -> tuple[Array, Array]:
    """Rows (trial, row) of logs, NaN at the end.

    A jump has a second knot, which repeats the row before; a padded log repeats its last.

    >>> _list_rows(np.array([[0.0, 1.0, 1.0, 1.0]]), np.array([[2.0, 2.0, 3.0, 3.0]]))[1]
    array([[ 2.,  3., nan, nan]])
    """
    last = np.append(np.diff(knot, axis=1) > 0.0, np.ones((len(knot), 1), bool), axis=1)
    rows = np.full((2, *knot.shape), np.nan)
    for trial, some in enumerate(last):
        rows[:, trial, : some.sum()] = knot[trial, some], torque[trial, some]
    return rows[0], rows[1]


def find_saturated_array(values: Array) -> Flags:
    """Find values (trial, n) at a limit; NaN is none.

    A value among neighbours of which half are at the limit counts too, since only those below it
    were let through.

    >>> noisy = np.sin(np.arange(60.0) ** 2) + np.linspace(0.0, 3.0, 60)
    >>> find_saturated_array(noisy[None]).any()
    np.False_
    >>> find_saturated_array(np.minimum(noisy, 2.0)[None])[0].sum() >= (noisy > 2.0).sum()
    np.True_
    """
    found = np.zeros(values.shape, bool)
    for side in (1.0, -1.0):
        at = _mark_limit(side * values)
        if at.any():
            found |= np.stack([_mark_between(row) for row in at])
    return found & np.isfinite(values)


def _mark_limit(values: Array) -> Flags:
    """Mark the values (trial, n) that are an upper limit."""
    known = np.isfinite(values)
    nothing = np.zeros(values.shape, bool)
    if not known.any():
        return nothing
    limit = values[known].max()
    at = known & (values == limit)
    change = np.abs(np.diff(values, axis=1))
    free = change[np.isfinite(change) & ~at[:, 1:] & ~at[:, :-1]]
    if len(free) < DECISIONS.least_values:
        return nothing
    usual = float(np.median(free))
    step = find_step_array(values[known & ~at])
    if usual <= 2.0 * step or usual == 0.0:
        return nothing
    moved = np.cumsum(known & ~at, axis=1) > 0  # where a trial begins at rest, it is at no limit
    near = known & ~at & (values >= limit - usual)
    count = int((at & moved).sum())
    return at if count >= DECISIONS.least_saturated and count > near.sum() else nothing


def _mark_between(at: Flags) -> Flags:
    """Mark values (n,) of whose neighbours half are marked."""
    width = min(DECISIONS.saturated_frames, len(at))
    share = np.convolve(at, np.ones(width) / width, "same")
    return at | (share >= 0.5)
