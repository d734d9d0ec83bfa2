"""Gaps between used frames, gathered on few nodes.

AR(1) noise stays free in the likelihood.

The noise enters a likelihood through functions of (gap, σ, ρ, C) that are smooth in log gap.
Few distinct gaps (even sampling with missing frames) are kept as they are; many (uneven sampling)
are spread over Chebyshev nodes in log gap by the weights of polynomial interpolation.
"""

import numpy as np
from numpy.typing import NDArray

from softfinger.measurement.budget import BUDGET

ROUNDING = 1e-3  # relative: gaps closer than this are one


def place_gap_nodes_array(gap: NDArray[np.float64]) -> NDArray[np.float64]:
    """Place nodes for all gaps of a campaign.

    The gaps (n,) are in median intervals.

    >>> place_gap_nodes_array(np.array([1.0, 1.0, 1.0001, 2.0]))
    array([1., 2.])
    """
    rounded = np.exp(np.round(np.log(gap) / ROUNDING) * ROUNDING)
    distinct, group = np.unique(rounded, return_inverse=True)
    if len(distinct) <= BUDGET.distinct_gaps:
        return np.array([np.median(gap[group == k]) for k in range(len(distinct))])
    low, high = np.log(gap.min()), np.log(gap.max())
    angle = (np.arange(BUDGET.gap_nodes) + 0.5) * np.pi / BUDGET.gap_nodes
    return np.exp(0.5 * (low + high) - 0.5 * (high - low) * np.cos(angle))


def spread_gaps_array(gap: NDArray[np.float64], nodes: NDArray[np.float64]) -> NDArray[np.float64]:
    """Spread gaps (n,) over nodes: weights (n, node).

    f(gap) ≈ Σ weight f(node).

    >>> spread_gaps_array(np.array([1.0, 2.0]), np.array([1.0, 2.0]))
    array([[1., 0.],
           [0., 1.]])
    """
    x, places = np.log(gap), np.log(nodes)
    if len(nodes) <= BUDGET.distinct_gaps:
        nearest = np.abs(x[:, None] - places).argmin(axis=1)
        return np.eye(len(nodes))[nearest]
    weights = np.ones((len(gap), len(nodes)))
    for k, place in enumerate(places):
        others = np.delete(places, k)
        weights[:, k] = np.prod((x[:, None] - others) / (place - others), axis=1)
    return weights
