"""Ω as numbers without bounds.

They are its Cholesky factor, the diagonal in logarithms. Along a line of them Ω stays positive.
"""

import numpy as np
from numpy.typing import NDArray

from softfinger.compiled import compiled


def subtract_omega(omega: NDArray[np.float64], other: NDArray[np.float64]) -> NDArray[np.float64]:
    """Change (d²,) from another Ω to this.

    It is that of `pack_omega`.
    """
    return pack_omega(np.ascontiguousarray(omega)) - pack_omega(np.ascontiguousarray(other))


def add_omega(omega: NDArray[np.float64], change: NDArray[np.float64]) -> NDArray[np.float64]:
    """Ω after a change as `subtract_omega` states it.

    >>> one, four = np.eye(1), 4 * np.eye(1)
    >>> add_omega(one, 0.5 * subtract_omega(four, one)).round(6)
    array([[2.]])
    """
    return unpack_omega(pack_omega(np.ascontiguousarray(omega)) + change, len(omega))


@compiled
def pack_omega(omega: NDArray) -> NDArray:
    """Cholesky factor of Ω, its diagonal in logarithms."""
    factor = np.linalg.cholesky(omega)
    for a in range(factor.shape[0]):
        factor[a, a] = np.log(factor[a, a])
    return factor.ravel()


@compiled
def unpack_omega(packed: NDArray, d: int) -> NDArray:
    """Ω of what `pack_omega` made of it."""
    factor = packed.copy().reshape(d, d)
    for a in range(d):
        factor[a, a] = np.exp(min(factor[a, a], 10.0))
    return factor @ factor.T
