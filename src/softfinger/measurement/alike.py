"""How far frames exceed their due, by frames that are alike.

Alike are frames with as long a time since the last change of load, of all trials and changes.
"""

import numpy as np
from numpy.typing import NDArray

from softfinger.measurement.decisions import DECISIONS

Array = NDArray[np.float64]


def find_usual_excess_array(excess: Array, since: Array, shortest: float = np.inf) -> Array:
    """Find the usual excess of the frames alike to each.

    It is the median of the others, at least 1; infinite where too few are alike. A frame's own
    neighbours do not count, for a gross error raises theirs: with one trial they are the frames
    that are most alike. Where fewer than `least_alike` count, as many sooner and later ones do too.

    Parameters
    ----------
    excess, since
        (trial, frame): what a frame adds to χ² over its due, NaN where unused; its time [s] since
        the last change.
    shortest
        [s] Frames that soon after a change are alike, or within a thousandth of the usual time.

    >>> find_usual_excess_array(np.array([[4.0, 9.0, 4.0, 1.0, 2.0, 3.0]]), np.ones((1, 6)))
    array([[2.5, 2. , 3. , 4. , 4. , 4. ]])
    """
    trial, frame = np.nonzero(np.isfinite(excess))
    value, time = excess[trial, frame], since[trial, frame]
    floor = min(np.median(time) * 1e-3, shortest)
    place = np.floor(DECISIONS.alike_per_decade * np.log10(np.maximum(time, floor) / floor))
    usual = np.full(len(value), np.inf)
    for group in np.unique(place):
        judged = np.flatnonzero(place == group)
        usual[judged] = _find_median_of_others(value, trial, place == group, judged)
    for i in np.flatnonzero(~np.isfinite(usual)):
        usual[i] = _find_median_around(value, trial, place, time, i)
    found = np.full(excess.shape, np.inf)
    found[trial, frame] = np.maximum(usual, 1.0)
    return found


def _find_median_of_others(
    value: Array, trial: NDArray[np.int64], alike: NDArray[np.bool_], judged: NDArray[np.int64]
) -> Array:
    """Median of the alike values but for those beside each.

    Left out are each judged value itself and its neighbours in the same trial. Infinite where
    fewer than `least_alike` are left. Leaving out what has the ranks r₁ < r₂ < r₃ moves what was
    on place p to p plus how many of r₁, r₂ − 1, r₃ − 2 it reaches.
    """
    ordered = np.append(np.sort(value[alike]), np.inf)
    count, beyond = len(ordered) - 1, 2 * len(value)
    rank = np.full(len(value), beyond)
    rank[alike] = np.argsort(np.argsort(value[alike]))
    beside = judged[:, None] + [0, 1, 2]
    own = np.pad(trial, 1, constant_values=-1)[beside] == trial[judged, None]
    out = np.sort(np.where(own, np.pad(rank, 1)[beside], beyond), axis=1)
    left = count - (out < beyond).sum(axis=1)
    middle = np.maximum((left[:, None] + [-1, 0]) // 2, 0)
    reached = (out[:, None] - np.arange(3) <= middle[..., None]).sum(axis=2)
    median = ordered[np.minimum(middle + reached, count)].mean(axis=1)
    return np.where(left < DECISIONS.least_alike, np.inf, median)


def _find_median_around(
    value: Array, trial: NDArray[np.int64], place: Array, time: Array, i: int
) -> float:
    """Median of what is alike to i, sooner and later.

    What is left of a model's misfit decays, so its median over as many frames on both sides is no
    less than at i. Infinite where one side has fewer than `least_alike`.
    """
    order = np.argsort(time, kind="stable")
    order = order[(trial[order] != trial[i]) | (abs(order - i) > 1)]
    sooner = order[place[order] < place[i]][-DECISIONS.least_alike :]
    later = order[place[order] > place[i]][: DECISIONS.least_alike]
    if min(len(sooner), len(later)) < DECISIONS.least_alike:
        return np.inf
    return float(np.median(value[[*sooner, *order[place[order] == place[i]], *later]]))
