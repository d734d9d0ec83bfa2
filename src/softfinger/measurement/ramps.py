"""Loads that move from row to row, as straight lines.

A row that differs from the one closely before it is read as a step (`campaign.load_log`). A ramp or
a wave of several rows is then a stair, half a row late. It is straight from row to row instead, and
leaves the level before and meets the one after where its nearest rows lead. A step between two
levels stays one, also where the levels drift, and so does any that rows far apart state: the log
itself has two values there.

A rig may also hold each set point until the next. A stair of which the readings scatter is taken as
the same lines, half a row later: small steps and their middles move a finger alike.

Under a log that is slower than the camera a ramp is read as lines from row to row. It begins and
ends between two of them all the same, where its nearest rows lead.
"""

from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from softfinger.measurement.decisions import DECISIONS

Array = NDArray[np.float64]


def straighten_ramps_array(
    time: Array, torque: Array, within: float, *, held: bool = False
) -> tuple[Array, Array]:
    """Replace steps that follow each other by lines.

    Parameters
    ----------
    time, torque
        (knot,) [s], [N m]; of two knots at one time the later one is a row. The last one may be
        repeated.
    within
        Time [s] within which two rows were read as a step.
    held
        Each row stays until the next one: lines are half a row later.

    Returns
    -------
    time, torque
        (knot,). Of each step the knot before it is at an end of the ramp, or equals the row.

    >>> stair = np.array([0.0, 1, 1, 2, 2, 3, 3, 4]), np.array([0.0, 0, 1, 1, 3, 3, 4, 4])
    >>> straighten_ramps_array(*stair, 1.5)
    (array([0. , 0.5, 1. , 2. , 2. , 2.5, 3. , 4. ]), array([0., 0., 1., 3., 3., 4., 4., 4.]))
    >>> straighten_ramps_array(*stair, 1.5, held=True)[0]
    array([0. , 1. , 1.5, 2.5, 2.5, 3. , 3.5, 4.5])
    """
    differs = (np.diff(time) != 0.0) | (np.diff(torque) != 0.0)
    number = 2 + np.flatnonzero(differs).max(initial=-1)  # of knots that are no repetition
    rows = np.flatnonzero(np.append(np.diff(time[:number]) > 0.0, True))
    rise = np.abs(np.diff(torque[rows]))
    is_near = np.diff(time[rows]) <= within
    beside = np.maximum(np.append(rise[1:], 0.0), np.append(0.0, rise[:-1]))
    is_near &= (rise == 0.0) | (DECISIONS.load_change * rise < beside)  # a step is much larger
    is_step = is_near & (np.diff(rows) > 1) & (rise != 0.0)
    turns = np.flatnonzero(np.diff(is_step, prepend=False, append=False))
    straight = time.copy(), torque.copy()
    for first, end in pairwise(turns):
        if is_step[first] and end - first > 1:
            row = rows[first : end + 1]
            knots = row[1:] - 1  # that hold the row before
            straight[0][knots], straight[1][knots] = _join_rows(time[row], torque[row])
    if held:
        half = 0.5 * np.where(is_near, np.diff(time[rows]), 0.0)
        straight[0][rows[0] + 1 : number] += np.repeat(half, np.diff(rows))
    return np.maximum.accumulate(straight[0]), straight[1]


def turn_between_rows_array(
    time: Array, torque: Array, gaps: NDArray[np.int64]
) -> tuple[Array, Array]:
    """Let ramps turn between the rows of a slow log.

    Parameters
    ----------
    time, torque
        (knot,) [s], [N m]; the last one may be repeated.
    gaps
        (gap,) knots from which the load runs to the next, as of `find_open_gaps_array`. Two at
        least, one after the other, are a ramp. It turns where the load rests beside it, and where
        it meets another one.

    Returns
    -------
    time, torque
        (knot + turn,).

    >>> time, load = np.arange(6.0), np.array([0.0, 0.0, 1.0, 3.0, 4.0, 4.0])
    >>> turn_between_rows_array(time, load, np.array([1, 2, 3]))[0]
    array([0. , 1. , 1.5, 2. , 3. , 3.5, 4. , 5. ])
    """
    moves = np.abs(np.diff(torque)) * (np.diff(time) > 0.0)
    beside = np.pad(moves, 1)
    at, when, level = _find_crests(time, torque, gaps)
    for run in np.split(gaps, np.flatnonzero(np.diff(gaps) != 1) + 1):
        if run.size < 2:
            continue
        # a last row may rise by less than a change of load
        first, last = run[0] - (beside[run[0]] > 0.0), run[-1] + (beside[run[-1] + 2] > 0.0)
        row = slice(first, last + 2)
        joined = _join_rows(time[row], torque[row])[0]
        ends = (first, first, 0, torque[first]), (last, last + 2, -1, torque[last + 1])
        for gap, next_to, end, rests_at in ends:
            if beside[next_to] <= DECISIONS.load_change * moves[gap]:
                at.append(gap + 1)
                when.append(joined[end])
                level.append(rests_at)
    return np.insert(time, at, when), np.insert(torque, at, level)


def _find_crests(
    time: Array, torque: Array, gaps: NDArray[np.int64]
) -> tuple[list[int], list[float], list[float]]:
    """Where two ramps meet within a gap.

    Returns the knot after it, time and load. Each ramp is a straight line over two gaps at least.
    """
    is_open = np.zeros(len(time) + 4, bool)  # gaps from −2 on
    is_open[gaps + 2] = True
    meets = is_open[:-4] & is_open[1:-3] & is_open[3:-1] & is_open[4:]
    at, when, level = [], [], []
    for gap in np.flatnonzero(meets):
        beside = gap + np.array([-2, -1, 1, 2])
        slope = (torque[beside + 1] - torque[beside]) / (time[beside + 1] - time[beside])
        slight = DECISIONS.load_change * np.abs(slope).max()
        turn, wide = slope[1] - slope[2], time[gap + 1] - time[gap]
        if max(abs(slope[1] - slope[0]), abs(slope[3] - slope[2])) > slight or abs(turn) <= slight:
            continue
        after = (torque[gap + 1] - torque[gap] - slope[2] * wide) / turn
        if 0.0 < after < wide:
            at.append(gap + 1)
            when.append(time[gap] + after)
            level.append(torque[gap] + slope[1] * after)
    return at, when, level


def _join_rows(time: Array, torque: Array) -> tuple[Array, Array]:
    """Knots before rows of a ramp, from level to level.

    It is at either end as steep as within its nearest rows, and at least as the end asks.
    """
    rise = np.diff(torque)
    steep = rise / np.diff(time)
    begins = time[1] - rise[0] / _find_steepest(steep[0], steep[1])
    ends = time[-2] + rise[-1] / _find_steepest(steep[-1], steep[-2])
    begins, ends = max(begins, time[0]), min(ends, time[-1])  # but for rounding they are
    return np.array([begins, *time[2:-1], ends]), np.array([torque[0], *torque[2:]])


def _find_steepest(at_end: float, inside: float) -> float:
    goes_on = np.sign(inside) == np.sign(at_end)
    return inside if goes_on and abs(inside) > abs(at_end) else at_end
