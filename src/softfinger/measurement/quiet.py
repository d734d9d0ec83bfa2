"""When a load changes, and when the finger rests.

It rests long after a change.
"""

import numpy as np
from numpy.typing import NDArray

from softfinger.measurement.corners import find_corners_array
from softfinger.measurement.decisions import DECISIONS


def find_quiet_array(
    time: NDArray[np.float64], load_time: NDArray[np.float64], load_torque: NDArray[np.float64]
) -> NDArray[np.bool_]:
    """Mark the times (n,) far from load changes.

    They lie well after the last change of load and before the next one.

    A change is a knot at which the load jumps, or its slope turns, by more than 5 % of its range
    (a slope counts by what it moves along a straight piece beside the knot).

    >>> find_quiet_array(np.arange(6.0), np.array([0.0, 5.0]), np.array([1.0, 1.0]))
    array([False, False,  True,  True,  True, False])
    """
    return _count_settling(time, load_time, load_torque)[1] == 0


def split_smooth(
    time: NDArray[np.float64], load_time: NDArray[np.float64], load_torque: NDArray[np.float64]
) -> list[tuple[NDArray[np.int_], bool]]:
    """Frames of each stretch of smooth motion, and whether they rest.

    It is where the finger rests. Between two changes of load creep looks alike at any scale of
    time, so earlier stretches, each as long beside the time since the change, are as smooth. They
    count beside a window at rest where their frames are denser, and show what noise does between.

    >>> time = np.append(np.linspace(0.0, 25.0, 30), np.linspace(30.0, 129.0, 34))
    >>> found = split_smooth(time, np.array([0.0]), np.array([1.0]))
    >>> [(len(run), rests) for run, rests in found]
    [(4, False), (24, False), (33, True)]
    """
    phase, settling = _count_settling(time, load_time, load_torque)
    turns = np.flatnonzero((np.diff(phase) != 0) | (np.diff(settling) != 0.0)) + 1
    kept: list[tuple[NDArray[np.int_], bool]] = []
    resting = 0.0  # median gap of the phase's window at rest
    for run in reversed(np.split(np.arange(len(time)), turns)):
        count = settling[run[0]]
        if not np.isfinite(count):
            continue
        gap = np.median(np.diff(time[run])) if len(run) > 1 else np.inf
        if count == 0.0:
            resting = gap if len(run) >= DECISIONS.least_window_frames else 0.0
        if count == 0.0 or DECISIONS.denser * gap <= resting:
            kept.insert(0, (run, bool(count == 0.0)))
    return kept


def _count_settling(
    time: NDArray[np.float64], load_time: NDArray[np.float64], load_torque: NDArray[np.float64]
) -> tuple[NDArray[np.int_], NDArray[np.float64]]:
    """Number of the last change (n,), and of stretches before rest (n,).

    The latter is NaN at a change and at the recording's ends.
    """
    changes = find_load_changes_array(load_time, load_torque)
    edges = np.concatenate([[-np.inf], changes, [np.inf]])
    phase = np.searchsorted(edges, time, side="right") - 1
    begin = np.maximum(edges[phase], time[0])
    end = np.minimum(edges[phase + 1], time[-1])
    inside = (time > begin) & (time < end)
    share = np.where(inside, time - begin, 1.0) / np.where(inside, end - begin, 1.0)
    share = np.where(edges[phase] > -np.inf, share, 1.0)  # before the first change it rests
    settling = np.floor(np.log(share) / np.log(DECISIONS.unsettled))
    return phase, np.where(inside, settling, np.nan)


def find_load_changes_array(
    load_time: NDArray[np.float64], load_torque: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Find the times [s] of noticeable load changes.

    The load or its slope changes. A slope is that of a straight piece, whatever rows it has.

    >>> find_load_changes_array(np.array([0.0, 4.0, 4.0, 8.0]), np.array([0.0, 0.0, 1.0, 1.0]))
    array([4.])
    """
    size = max(np.ptp(load_torque), np.abs(load_torque).max())
    if size == 0:
        return np.empty(0)
    threshold = DECISIONS.load_change * size
    corners = find_corners_array(load_time, load_torque, DECISIONS.straight * size)
    load_time, load_torque = load_time[corners], load_torque[corners]
    step = np.diff(load_time)
    rise = np.diff(load_torque)
    slope = np.divide(rise, step, out=np.zeros_like(rise), where=step > 0)
    span = np.append(step, 0.0)
    before, after = np.insert(slope, 0, 0.0), np.append(slope, 0.0)
    turn = np.abs(after - before) * np.maximum(span, np.insert(step, 0, 0.0))
    jump = np.concatenate([[load_torque[0]], np.where(step > 0, 0.0, rise)])
    return np.unique(load_time[(turn > threshold) | (np.abs(jump) > threshold)])


def compute_time_since_array(
    time: NDArray[np.float64], load_time: NDArray[np.float64], load_torque: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Compute the time (n,) [s] since the last change.

    Before any change of load, it counts from the beginning of the recording.

    >>> compute_time_since_array(np.array([1.0, 2.5, 3.0]), np.array([2.0]), np.array([1.0]))
    array([0. , 0.5, 1. ])
    """
    changes = np.sort(np.append(time[0], find_load_changes_array(load_time, load_torque)))
    last = np.searchsorted(changes, time, side="right") - 1
    return time - changes[np.maximum(last, 0)]
