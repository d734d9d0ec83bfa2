"""The log behind a largest rate: straight lines again, with the derivative by the slowness."""

import math

import numpy as np
from numpy.typing import NDArray

from softfinger.compiled import compiled


@compiled
def slow_log(time: NDArray, load: NDArray, slowness: float) -> tuple[NDArray, NDArray, NDArray]:
    """Follow a log from 0 no faster than 1/slowness; any rate where that is 0.

    Returns knots (knot,) of time, load and its derivative by the slowness. A jump of either is two
    knots at one time.
    """
    last = time.size - 1
    if not slowness > 0.0:
        return time.copy(), load.copy(), np.zeros(time.size)
    knots, count, rate = np.zeros((3, 8 * time.size)), np.int64(0), 1.0 / slowness
    value = 0.0
    slower = 0.0
    for knot in range(time.size):
        now, end = time[knot], time[min(knot + 1, last)]
        goal, slope = load[knot], 0.0
        if knot < last and end > now:
            slope = (load[knot + 1] - goal) / (end - now)
        if knot == last:
            end = np.inf
        while now < end:
            knots[0, count], knots[1, count], knots[2, count] = now, value, slower
            count += 1
            gap = goal - value
            if gap == 0.0 and abs(slope) <= rate:  # it follows
                if knot < last:
                    value = load[knot + 1]
                break
            way = math.copysign(1.0, gap if gap != 0.0 else slope)
            closing, span = rate - way * slope, end - now
            caught = gap != 0.0 and closing > 0.0 and way * gap <= closing * span
            if caught:
                span = way * gap / closing
            now = now + span if caught else end
            value += way * rate * span
            slower -= way * span * rate * rate
            goal += slope * span
            if caught:
                knots[0, count], knots[1, count], knots[2, count] = now, goal, slower
                count += 1
                value, slower = goal, 0.0
    return knots[0, :count].copy(), knots[1, :count].copy(), knots[2, :count].copy()
