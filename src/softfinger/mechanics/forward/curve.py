"""A law of one argument, as a spline.

It is a smooth curve by a cubic B-spline, with its slope.

The knots are even over x = argument / reach from 0 to 1; outside, the curve goes on straight. Value
and slope are linear in the coefficients, so the derivative by a coefficient is a weight.
"""

import numpy as np
from numpy.typing import NDArray

from softfinger.compiled import compiled

KNOTS = 16
"""Coefficients of a law."""
_INTERVALS = KNOTS - 3

Weights = tuple[int, float, float, float, float]


@compiled
def weigh_value(x: float) -> Weights:
    """The first of four coefficients, and their weights."""
    inside = min(max(x, 0.0), 1.0)
    first, s0, s1, s2, s3 = weigh_slope(inside)
    s = inside * _INTERVALS - first
    r, beyond = 1.0 - s, x - inside
    w0, w3 = r * r * r / 6.0, s * s * s / 6.0
    w1 = (4.0 - 3.0 * s * s * (1.0 + r)) / 6.0
    w2 = (4.0 - 3.0 * r * r * (1.0 + s)) / 6.0
    return first, w0 + beyond * s0, w1 + beyond * s1, w2 + beyond * s2, w3 + beyond * s3


@compiled
def weigh_slope(x: float) -> Weights:
    """The same of the slope by x."""
    place = min(max(x, 0.0), 1.0) * _INTERVALS
    first = min(int(place), _INTERVALS - 1)
    s = place - first
    r = 1.0 - s
    s0, s3 = -0.5 * r * r * _INTERVALS, 0.5 * s * s * _INTERVALS
    s1 = 0.5 * s * (s - 2.0 - 2.0 * r) * _INTERVALS
    return first, s0, s1, -(s0 + s1 + s3), s3


@compiled
def combine(law: NDArray, weights: Weights) -> float:
    """Weigh the coefficients (knot,) of a law."""
    first, w0, w1, w2, w3 = weights
    return w0 * law[first] + w1 * law[first + 1] + w2 * law[first + 2] + w3 * law[first + 3]


def draw_curve(law: NDArray[np.float64], x: NDArray[np.float64]) -> NDArray[np.float64]:
    """Values of laws at places.

    Values (…, n) of laws (…, knot), at x (n,) of the reach.

    Examples
    --------
    >>> draw_curve(np.ones(KNOTS), np.array([-0.5, 0.3, 2.0]))
    array([1., 1., 1.])
    """
    return law @ build_weights(x).T


def build_weights(x: NDArray[np.float64]) -> NDArray[np.float64]:
    """Build the matrix from coefficients to values.

    It is (n, knot), for values at x (n,) of the reach.
    """
    weights = np.zeros((len(x), KNOTS))
    for row, place in zip(weights, x, strict=True):
        first, *four = weigh_value(float(place))
        row[first : first + 4] = four
    return weights
