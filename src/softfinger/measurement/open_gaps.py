"""Steps of the load that came somewhere between two rows.

A log states a step by two rows, and a straight line leads from one to the other. A step that comes
at any moment of this gap is that line on average. What it leaves is a Brownian bridge times the
rise, to its covariance: at shares u ≤ v of the gap u (1 − v). By Lévy's construction that is a sum
of hats, each times a normal number of its own: one over the gap of height 1/2, two over its halves
of height 1/√8, and so on.
"""

import numpy as np
from numpy.typing import NDArray

from softfinger.measurement.decisions import DECISIONS

Array = NDArray[np.float64]


def find_open_gaps_array(time: Array, torque: Array, interval: float) -> NDArray[np.int64]:
    """Find gaps of a log in which a step came.

    Parameters
    ----------
    time, torque
        (knot,) [s], [N m]; the last one may be repeated.
    interval
        Median frame interval [s].

    Returns
    -------
    knot
        (gap,) the knots from which the load runs to the next. Either the gap is as narrow as one
        that is read as a jump, and the load rests on both sides; or the log has rows as far apart
        where the load rests, a dozen of them, so that it states no ramp but reads seldom.

    >>> time, load = np.arange(20.0), np.append(np.zeros(14), np.full(6, 2.0))
    >>> find_open_gaps_array(time, load, 0.1)
    array([13])
    """
    differs = (np.diff(time) != 0.0) | (np.diff(torque) != 0.0)
    row = np.flatnonzero(np.append(differs, True))  # of alike ones the last
    apart, rise = np.diff(time[row]), np.abs(np.diff(torque[row]))
    change = DECISIONS.load_change * max(np.ptp(torque), np.abs(torque).max())
    between = np.maximum(np.pad(rise, 1)[:-2], np.pad(rise, 1)[2:]) <= change
    narrow = (apart > 0.0) & (apart <= DECISIONS.step_rows * interval)
    seldom = ~narrow & keeps_pace_array(apart[(rise <= change) & (apart > 0.0)], apart)
    return row[np.flatnonzero((rise > change) & ((narrow & between) | seldom))]


def keeps_pace_array(rests: Array, apart: Array) -> NDArray[np.bool_]:
    """Whether a log at rest has a dozen gaps as wide.

    Of (rest,) gaps where the load rests, and (gap,) others.

    >>> keeps_pace_array(np.full(12, 0.1), np.array([0.1, 0.2]))
    array([ True, False])
    """
    pace, near = np.sort(rests), (apart / DECISIONS.same_pace, apart * DECISIONS.same_pace)
    rows = np.searchsorted(pace, near[1], "right") - np.searchsorted(pace, near[0])
    return rows >= DECISIONS.pace_rows


def build_hats_array(levels: int) -> Array:
    """Hats (hat, node) whose squares add up to a bridge's variance.

    The nodes are evenly spaced over the gap, its two ends among them.

    >>> hats = build_hats_array(2)
    >>> (hats**2).sum(axis=0).round(6)
    array([0.    , 0.1875, 0.25  , 0.1875, 0.    ])
    """
    share = np.linspace(0.0, 1.0, 2**levels + 1)
    hats = []
    for level in range(levels):
        half = 0.5 ** (level + 1)
        centres = half * (1 + 2 * np.arange(2**level))
        hats += [np.sqrt(half / 2.0) * np.clip(1 - abs(share - c) / half, 0, 1) for c in centres]
    return np.array(hats)


def bridge_gaps_array(
    time: Array, torque: Array, gaps: NDArray[np.int64], levels: int
) -> tuple[Array, Array, Array]:
    """Open gaps of a log, and the bridge over each.

    Parameters
    ----------
    time, torque, gaps
        (knot,) [s], [N m], and as of `find_open_gaps_array`.
    levels
        Of hats: each doubles the nodes in a gap.

    Returns
    -------
    time, torque, bridge
        (node,) the same log with nodes in its gaps, and (gap · hat, node) [N m] what a unit of each
        hat adds to it.

    >>> time, load = np.arange(5.0), np.array([0.0, 0.0, 0.0, 2.0, 2.0])
    >>> time, load, bridge = bridge_gaps_array(time, load, np.array([2]), 1)
    >>> time[3], load[3], bridge
    (np.float64(2.5), np.float64(1.0), array([[0., 0., 0., 1., 0., 0.]]))
    """
    hats = build_hats_array(levels)
    inner = hats.shape[1] - 2
    share = np.linspace(0.0, 1.0, inner + 2)[1:-1]
    at = np.repeat(gaps + 1, inner)

    def open_gaps(values: Array) -> Array:
        line = values[gaps, None] + share * (values[gaps + 1] - values[gaps])[:, None]
        return np.insert(values, at, line.ravel())

    node = np.arange(len(gaps))[:, None] * inner + gaps[:, None] + 1 + np.arange(inner)
    bridge = np.zeros((len(gaps), len(hats), len(time) + at.size))
    rise = torque[gaps + 1] - torque[gaps]
    for gap, nodes in enumerate(node):
        bridge[gap][:, nodes] = rise[gap] * hats[:, 1:-1]
    return open_gaps(time), open_gaps(torque), bridge.reshape(-1, bridge.shape[2])
