"""Small dense linear systems, solved in place without allocation."""

from numba import njit
from numpy.typing import NDArray


@njit(cache=True)
def factorise(matrix: NDArray) -> None:
    """LU without pivoting, in place: M, and M plus a positive damping, need none."""
    n = matrix.shape[0]
    for k in range(n):
        for i in range(k + 1, n):
            matrix[i, k] /= matrix[k, k]
            for j in range(k + 1, n):
                matrix[i, j] -= matrix[i, k] * matrix[k, j]


@njit(cache=True)
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
