"""When a step of the load came within its gap.

A log states a step by two rows. When between them the load changed it does not show; the later row
is where a step counts (`campaign.load_log`). A log that reads a load as often as a camera takes
frames has steps that come half a gap sooner on average: all motion then seems too early.
"""

import numpy as np
from numpy.typing import NDArray

from softfinger.measurement.decisions import DECISIONS
from softfinger.measurement.open_gaps import keeps_pace_array

Array = NDArray[np.float64]


def find_step_gaps_array(load_time: Array, load_torque: Array, frame_interval: float) -> Array:
    """Gaps [s] within which steps came; 0 at knots of none.

    Knots are (…, knot), the load's two at a step have the same gap. Either the gap is narrow, or
    the log reads as seldom where the load rests. Rests that each end in a step are no such reading:
    the log then states its steps alone.

    >>> knots, load = np.array([0.0, 1.0, 1.1, 1.1, 2.0]), np.array([0.0, 0.0, 0.0, 4.0, 4.0])
    >>> find_step_gaps_array(knots, load, 0.1).round(6)
    array([0. , 0. , 0.1, 0.1, 0. ])
    """
    apart, rise = np.diff(load_time), np.diff(load_torque)
    step = (apart[..., 1:] == 0.0) & (rise[..., 1:] != 0.0)
    before, rests = apart[..., :-1], (apart[..., :-1] > 0.0) & (rise[..., :-1] == 0.0) & ~step
    within = step & (before <= DECISIONS.step_rows * frame_interval)
    for log in map(tuple, np.argwhere((step & ~within).any(axis=-1))):
        within[log] |= step[log] & keeps_pace_array(before[log][rests[log]], before[log])
    gap = np.where(within, before, 0.0)
    found = np.zeros(load_time.shape)
    found[..., 1:-1] = gap
    found[..., 2:] = np.maximum(found[..., 2:], gap)
    return found


def list_steps_array(load_time: Array, load_torque: Array, frame_interval: float) -> Array:
    """Gaps [s] of all steps of a load, one after the other.

    Of knots (trial, knot): (trial, step), 0 where a trial has fewer.

    >>> knots, load = np.array([[0.0, 1.0, 1.1, 1.1, 2.0]]), np.array([[0.0, 0.0, 0.0, 4.0, 4.0]])
    >>> list_steps_array(knots, load, 0.1).round(6)
    array([[0.1]])
    """
    gaps = find_step_gaps_array(load_time, load_torque, frame_interval)
    number = _number_steps(load_time, gaps)
    listed = np.zeros((len(gaps), int(number.max(initial=-1)) + 1))
    trial, knot = np.nonzero(number >= 0)
    listed[trial, number[trial, knot]] = gaps[trial, knot]
    return listed


def place_steps_array(
    load_time: Array, load_torque: Array, share: Array, frame_interval: float
) -> Array:
    """Move each step sooner by a share of its gap.

    Shares are (trial, step) as of `list_steps_array`; returns the times [s] of knots (trial, knot).

    >>> knots, load = np.array([[0.0, 1.0, 1.1, 1.1, 2.0]]), np.array([[0.0, 0.0, 0.0, 4.0, 4.0]])
    >>> place_steps_array(knots, load, np.array([[0.5]]), 0.1).round(6)
    array([[0.  , 1.  , 1.05, 1.05, 2.  ]])
    """
    gaps = find_step_gaps_array(load_time, load_torque, frame_interval)
    number = _number_steps(load_time, gaps)
    padded = np.append(share, np.zeros((len(share), 1)), axis=1)  # of no step, −1, there is none
    return _forget_rounding(load_time - np.take_along_axis(padded, number, axis=1) * gaps)


def _number_steps(load_time: Array, gaps: Array) -> NDArray[np.int64]:
    """Which step a knot (trial, knot) belongs to; −1 for none."""
    first = (gaps > 0.0) & (np.diff(load_time, append=np.inf) == 0.0)
    return np.where(gaps > 0.0, np.cumsum(first, axis=1) - 1, -1)


def advance_steps_array(
    load_time: Array, load_torque: Array, share: float, frame_interval: float
) -> Array:
    """Move all steps sooner by one share of their gaps.

    Returns the times [s] of all knots (…, knot).

    >>> knots, load = np.array([0.0, 1.0, 1.1, 1.1, 2.0]), np.array([0.0, 0.0, 0.0, 4.0, 4.0])
    >>> advance_steps_array(knots, load, 0.5, 0.1).round(6)
    array([0.  , 1.  , 1.05, 1.05, 2.  ])
    """
    gaps = find_step_gaps_array(load_time, load_torque, frame_interval)
    return _forget_rounding(load_time - share * gaps)


def open_steps_array(load_time: Array, load_torque: Array, frame_interval: float) -> Array:
    """Make of steps straight lines over their gaps.

    Returns the times [s] of all knots (…, knot).

    >>> knots, load = np.array([0.0, 1.0, 1.1, 1.1, 2.0]), np.array([0.0, 0.0, 0.0, 4.0, 4.0])
    >>> open_steps_array(knots, load, 0.1).round(6)
    array([0. , 1. , 1. , 1.1, 2. ])
    """
    gaps = find_step_gaps_array(load_time, load_torque, frame_interval)
    first = np.diff(load_time, append=np.inf) == 0.0  # of the two knots of a step
    return _forget_rounding(load_time - np.where(first, gaps, 0.0))


def _forget_rounding(time: Array) -> Array:
    """Times that rounding alone lets run backwards, in their order."""
    return np.maximum.accumulate(time, axis=-1)
