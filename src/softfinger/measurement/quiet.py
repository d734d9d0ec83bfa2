"""When a load changes, and when the finger rests.

It rests long after a change.
"""

import numpy as np
from numpy.typing import NDArray

from softfinger.measurement.decisions import DECISIONS


def find_quiet_array(
    time: NDArray[np.float64], load_time: NDArray[np.float64], load_torque: NDArray[np.float64]
) -> NDArray[np.bool_]:
    """Mark the times (n,) far from load changes.

    They lie well after the last change of load and before the next one.

    A change is a knot at which the load jumps, or its slope turns, by more than 5 % of its range
    (a slope counts by what it moves in the time to the next knot).

    >>> find_quiet_array(np.arange(6.0), np.array([0.0, 5.0]), np.array([1.0, 1.0]))
    array([False, False,  True,  True,  True, False])
    """
    changes = find_load_changes_array(load_time, load_torque)
    edges = np.concatenate([[-np.inf], changes, [np.inf]])
    phase = np.searchsorted(edges, time, side="right") - 1
    begin = np.maximum(edges[phase], time[0])
    end = np.minimum(edges[phase + 1], time[-1])
    unsettled = np.where(edges[phase] > -np.inf, DECISIONS.unsettled, 0.0)
    return (time > begin + unsettled * (end - begin)) & (time < end)


def find_load_changes_array(
    load_time: NDArray[np.float64], load_torque: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Find the times [s] of noticeable load changes.

    The load or its slope changes.

    >>> find_load_changes_array(np.array([0.0, 4.0, 4.0, 8.0]), np.array([0.0, 0.0, 1.0, 1.0]))
    array([4.])
    """
    threshold = DECISIONS.load_change * max(np.ptp(load_torque), np.abs(load_torque).max())
    if threshold == 0:
        return np.empty(0)
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
