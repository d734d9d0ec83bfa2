"""The chain of N links in a plane.

M(q) q̈ + h(q, q̇), from the Lagrangian, once for any N.

    L = Σ_i ½ m_i |v_i|² + ½ I_i θ̇_i²,   θ_i = Σ_{j≤i} q_j   (absolute direction of link i)

In the directions θ the kinetic energy is ½ Σ_jk a_jk cos(θ_j − θ_k) θ̇_j θ̇_k with constants

    a_jk = Σ_i m_i b_ij b_ik + δ_jk I_j,   b_ij = link_length_j (j < i) or link_centre_i (j = i),

so that Lagrange's equations read Σ_k a_jk [cos(θ_j − θ_k) θ̈_k + sin(θ_j − θ_k) θ̇_k²] = Q_j, and
a sum from each joint to the tip, over rows and columns, takes them to the joint angles q. The
finger moves in the horizontal plane: no gravity.
"""

import numpy as np
from numpy.typing import NDArray

from softfinger.compiled import compiled
from softfinger.mechanics.geometry import FingerGeometry


def compute_inertia_coefficients(geometry: FingerGeometry) -> NDArray[np.float64]:
    """Compute the constants of the kinetic energy.

    They are a_jk (joint, joint) [kg m²].

    >>> rod = FingerGeometry.uniform([1.0], [3.0], 0.008, 0.005)
    >>> compute_inertia_coefficients(rod)  # m l²/3 about its end
    array([[1.]])
    """
    reach = np.tril(np.broadcast_to(geometry.link_length, (geometry.joints,) * 2), -1)
    reach = reach + np.diag(geometry.link_centre)
    return np.einsum("i,ij,ik->jk", geometry.link_mass, reach, reach) + np.diag(
        geometry.link_inertia
    )


@compiled
def fill_inertia_and_nonlinear_term(
    angle: NDArray, velocity: NDArray, coefficients: NDArray, matrix: NDArray, term: NDArray
) -> None:
    """Write M(q) and h(q, q̇), in place.

    M goes into `matrix` (joint, joint), h into `term` (joint,).
    """
    n = angle.size
    for j in range(n):
        matrix[j, j] = coefficients[j, j]
        term[j] = 0.0
    spin_j = 0.0
    for j in range(n):
        spin_j += velocity[j]
        relative, spin_k = 0.0, spin_j
        for k in range(j + 1, n):
            relative += angle[k]  # θ_k − θ_j
            spin_k += velocity[k]
            cosine, sine = np.cos(relative), np.sin(relative)
            matrix[j, k] = matrix[k, j] = coefficients[j, k] * cosine
            pull = coefficients[j, k] * sine
            term[j] -= pull * spin_k * spin_k
            term[k] += pull * spin_j * spin_j
    sum_to_tip(matrix)
    for j in range(n - 2, -1, -1):
        term[j] += term[j + 1]


@compiled
def fill_slopes(
    angle: NDArray,
    velocity: NDArray,
    acceleration: NDArray,
    coefficients: NDArray,
    by_angle: NDArray,
    by_velocity: NDArray,
) -> None:
    """Write the derivatives of M q̈ + h.

    They are ∂(M q̈ + h)/∂q at fixed acceleration and ∂h/∂q̇ (joint, joint).
    """
    n = angle.size
    by_angle[:] = 0.0
    by_velocity[:] = 0.0
    spin_j, turn_j = 0.0, 0.0
    for j in range(n):
        spin_j += velocity[j]
        turn_j += acceleration[j]
        relative, spin_k, turn_k = 0.0, spin_j, turn_j
        for k in range(j + 1, n):
            relative += angle[k]
            spin_k += velocity[k]
            turn_k += acceleration[k]
            level = coefficients[j, k] * np.cos(relative)
            pull = coefficients[j, k] * np.sin(relative)
            to_k = -pull * turn_k - level * spin_k * spin_k  # row j by θ_k
            to_j = pull * turn_j - level * spin_j * spin_j  # row k by θ_j
            by_angle[j, k] += to_k
            by_angle[j, j] -= to_k
            by_angle[k, j] += to_j
            by_angle[k, k] -= to_j
            by_velocity[j, k] = -2.0 * pull * spin_k
            by_velocity[k, j] = 2.0 * pull * spin_j
    sum_to_tip(by_angle)
    sum_to_tip(by_velocity)


@compiled
def sum_to_tip(matrix: NDArray) -> None:
    """Sum the entries from each on, in place.

    Each becomes the sum of those from its row and column on.
    """
    n = matrix.shape[0]
    for j in range(n - 2, -1, -1):
        for k in range(n):
            matrix[j, k] += matrix[j + 1, k]
    for j in range(n):
        for k in range(n - 2, -1, -1):
            matrix[j, k] += matrix[j, k + 1]
