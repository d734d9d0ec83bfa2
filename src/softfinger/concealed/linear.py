"""Small dense linear algebra without library calls."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from softfinger.compiled import compiled
from softfinger.concealed.arrays import Array


@compiled(forceinline=True)
def factor_in_place(matrix: Array, order: NDArray[np.int64]) -> None:
    """LU with row exchange, over the matrix."""
    n = matrix.shape[0]
    for i in range(n):
        pivot = i
        for r in range(i + 1, n):
            if abs(matrix[r, i]) > abs(matrix[pivot, i]):
                pivot = r
        order[i] = pivot
        for k in range(n):
            matrix[i, k], matrix[pivot, k] = matrix[pivot, k], matrix[i, k]
        for r in range(i + 1, n):
            if matrix[r, i] != 0.0:
                matrix[r, i] /= matrix[i, i]
                for k in range(i + 1, n):
                    matrix[r, k] -= matrix[r, i] * matrix[i, k]


@compiled(forceinline=True)
def solve_in_place(factors: Array, order: NDArray[np.int64], vector: Array) -> None:
    """Solution of matrix · x = vector.

    It is written over the vector. The factors come from `factor_in_place`.
    """
    n = vector.size
    for i in range(n):
        vector[i], vector[order[i]] = vector[order[i]], vector[i]
    for i in range(n):
        for k in range(i):
            vector[i] -= factors[i, k] * vector[k]
    for i in range(n - 1, -1, -1):
        for k in range(i + 1, n):
            vector[i] -= factors[i, k] * vector[k]
        vector[i] /= factors[i, i]
