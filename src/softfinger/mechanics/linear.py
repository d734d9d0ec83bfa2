"""Small dense linear systems, solved in place without allocation."""

import numpy as np
from numpy.typing import NDArray

from softfinger.compiled import compiled


@compiled
def factorise(matrix: NDArray) -> None:
    """LU without pivoting, in place, for positive M."""
    n = matrix.shape[0]
    for k in range(n):
        for i in range(k + 1, n):
            matrix[i, k] /= matrix[k, k]
            for j in range(k + 1, n):
                matrix[i, j] -= matrix[i, k] * matrix[k, j]


@compiled
def solve_factorised(matrix: NDArray, vector: NDArray) -> None:
    """Solve in place with the factors of `factorise`."""
    n = vector.size
    for i in range(n):
        for j in range(i):
            vector[i] -= matrix[i, j] * vector[j]
    for i in range(n - 1, -1, -1):
        for j in range(i + 1, n):
            vector[i] -= matrix[i, j] * vector[j]
        vector[i] /= matrix[i, i]


@compiled
def factorise_pivoted(matrix: NDArray, pivot: NDArray) -> bool:
    """LU with row exchanges, in place; False: singular."""
    n = matrix.shape[0]
    for k in range(n):
        best = k
        for i in range(k + 1, n):
            if abs(matrix[i, k]) > abs(matrix[best, k]):
                best = i
        pivot[k] = best
        if not 0.0 < abs(matrix[best, k]) < np.inf:
            return False
        if best != k:
            for j in range(n):
                matrix[k, j], matrix[best, j] = matrix[best, j], matrix[k, j]
        for i in range(k + 1, n):
            matrix[i, k] /= matrix[k, k]
            if matrix[i, k] != 0.0:
                for j in range(k + 1, n):
                    matrix[i, j] -= matrix[i, k] * matrix[k, j]
    return True


@compiled
def solve_pivoted(matrix: NDArray, pivot: NDArray, vector: NDArray) -> None:
    """Solve in place with the factors of `factorise_pivoted`."""
    for k in range(vector.size):
        vector[k], vector[pivot[k]] = vector[pivot[k]], vector[k]
    solve_factorised(matrix, vector)


@compiled
def solve_columns(matrix: NDArray, pivot: NDArray, columns: NDArray) -> None:
    """Solve columns (n, column), in place, after `factorise_pivoted`."""
    n, count = columns.shape
    for k in range(n):
        if pivot[k] != k:
            for c in range(count):
                columns[k, c], columns[pivot[k], c] = columns[pivot[k], c], columns[k, c]
    for i in range(n):
        for j in range(i):
            for c in range(count):
                columns[i, c] -= matrix[i, j] * columns[j, c]
    for i in range(n - 1, -1, -1):
        for j in range(i + 1, n):
            for c in range(count):
                columns[i, c] -= matrix[i, j] * columns[j, c]
        for c in range(count):
            columns[i, c] /= matrix[i, i]
