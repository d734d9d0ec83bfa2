"""Shapes that begin at a moment, as the noise's filter sees them.

A shape that begins at frame s surprises the filter of `measurement.memory.whiten_array` by e_s, its
size there, and later by

    e_t = u_t − ρ_t (u_{t−1} − (1 − g_{t−1}) e_{t−1}),

where ρ_t is the correlation of what lasts with the frame before, g the filter's gain and u the
shape's size. The whitened shape is e_t over the filter's sd; its products with whitened rows are
sums of such, which one pass from the last frame to the first yields for all s.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from softfinger.compiled import compiled
from softfinger.measurement.memory import Memory, update_doubt

Array = NDArray[np.float64]


class Onset(NamedTuple):
    """Products (s, k) of a shape from frame s with whitened rows, and its norms² (s,)."""

    product: Array
    square: Array


def project_onsets(rows: Array, size: Array, gap: Array, memory: Memory) -> tuple[Onset, ...]:
    """Project a step, a wrong frame and an innovation.

    Parameters
    ----------
    rows
        (n, k), whitened.
    size
        (n,) of the shapes, in sd of the noise there.
    gap
        (n,) time since the frame before, in median frame intervals; the first is not read.

    Returns
    -------
    step, wrong, innovation : Onset
        From frame s on the size of each frame; that of frame s alone; and what lasting noise keeps
        of that.

    Examples
    --------
    >>> rows, one = np.array([[1.0], [2.0]]), np.ones(2)
    >>> [o.product.ravel() for o in project_onsets(rows, one, one, Memory(0.0))]
    [array([3., 2.]), array([1., 2.]), array([1., 2.])]
    """
    n = len(rows)
    products = np.empty((3, n, rows.shape[1]))
    squares = np.empty((3, n))
    whole = np.ascontiguousarray(rows, float), np.asarray(size, float), np.asarray(gap, float)
    _fill_onsets(*whole, *map(float, memory), products, squares)
    return tuple(map(Onset, products, squares))


@compiled
def _fill_onsets(
    rows: NDArray,
    size: NDArray,
    gap: NDArray,
    rho: float,
    share: float,
    products: NDArray,
    squares: NDArray,
) -> None:
    """Fill `products` (3, n, k) and `squares` (3, n), from the last frame to the first."""
    n, k = rows.shape
    carried, spread, gain = np.zeros(n + 1), np.ones(n), np.zeros(n)
    unsure = 0.0
    for t in range(n):
        carried[t] = 0.0 if t == 0 else rho ** gap[t]
        spread[t], gain[t], unsure = update_doubt(unsure, carried[t], share)
    # what a surprise e at t brings from t on: e · one + rest, and twice · e² + 2 mixed · e + square
    one, rest = np.zeros(k), np.zeros(k)
    twice, mixed, square = 0.0, 0.0, 0.0
    for t in range(n - 1, -1, -1):
        later = carried[t + 1]
        fresh = size[t + 1] - later * size[t] if t + 1 < n else 0.0
        kept, lost = later * (1.0 - gain[t]), -later * gain[t] * size[t]
        squares[1, t] = size[t] ** 2 / spread[t] + twice * lost**2
        square += fresh * (twice * fresh + 2.0 * mixed)
        mixed = kept * (twice * fresh + mixed)
        twice = 1.0 / spread[t] + kept**2 * twice
        squares[0, t] = size[t] * (twice * size[t] + 2.0 * mixed) + square
        squares[2, t] = size[t] ** 2 * twice
        for i in range(k):
            here = rows[t, i] / np.sqrt(spread[t])
            products[1, t, i] = size[t] * here + lost * one[i]
            rest[i] += fresh * one[i]
            one[i] = here + kept * one[i]
            products[0, t, i] = size[t] * one[i] + rest[i]
            products[2, t, i] = size[t] * one[i]
