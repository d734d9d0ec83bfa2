"""Trials that lie apart in one number."""

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
LEAST_TRIALS = 3
# The gap must be so many times the spread within the groups it parts: chance alone makes gaps of
# some spreads where a population has heavy tails.
GAP_IN_SPREADS = 4.0


def find_apart(values: Array, least_gap: float) -> NDArray[np.bool_]:
    """Members beyond a wide gap from the larger group.

    Of two equal halves it is the upper.

    Parameters
    ----------
    values : (trial,)
        NaN = unknown.
    least_gap : float
        Gaps below it are no mistake, whatever the spread.

    Examples
    --------
    >>> find_apart(np.array([1.0, 1.2, 9.0, 1.1]), 1.0)
    array([False, False,  True, False])
    >>> find_apart(np.array([1.0, 2.0, 3.0, 4.0]), 0.5).any()
    np.False_
    """
    apart = np.zeros(values.size, bool)
    known = np.flatnonzero(np.isfinite(values))
    if known.size < LEAST_TRIALS:
        return apart
    order = known[np.argsort(values[known])]
    ordered = values[order]
    gaps = np.diff(ordered)
    cut = int(np.argmax(gaps)) + 1
    low, high = ordered[:cut], ordered[cut:]
    within = np.sqrt((cut * low.var() + high.size * high.var()) / max(known.size - 2, 1))
    if gaps[cut - 1] < max(least_gap, GAP_IN_SPREADS * within):
        return apart
    apart[order[:cut] if low.size < high.size else order[cut:]] = True
    return apart
