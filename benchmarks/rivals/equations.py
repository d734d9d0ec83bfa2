"""The equations of motion that every solver of the forward model integrates, compiled.

State (q, q̇, q_v) of three joints, as in `softfinger.mechanics.dynamics`. Nothing is allocated.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from softfinger.compiled import compiled
from softfinger.mechanics.chain import (
    compute_inertia_coefficients,
    fill_inertia_and_nonlinear_term,
    fill_slopes,
)
from softfinger.mechanics.geometry import FingerGeometry
from softfinger.mechanics.linear import factorise, solve_factorised
from softfinger.mechanics.wires import moment_arm, moment_arm_slope

GEOMETRY = FingerGeometry.uniform([0.025] * 3, [0.005] * 3, 0.008, 0.005)
INERTIA = compute_inertia_coefficients(GEOMETRY)
HALF_LENGTH, OFFSET, TENSION = GEOMETRY.joint_length / 2, GEOMETRY.wire_offset, 8.0
JOINTS, STATES = 3, 9
ROOM = 3 * JOINTS * JOINTS + JOINTS + STATES  # what rates and slopes are computed in


@compiled
def fill_rate(
    state: NDArray, k_v: NDArray, c_v: NDArray, c_p: NDArray, room: NDArray, rate: NDArray
) -> None:
    """Write the rates of (q, q̇, q_v) at full tension."""
    angle, velocity, elastic = state[:3], state[3:6], state[6:]
    matrix, push = room[:9].reshape(3, 3), room[9:12]
    fill_inertia_and_nonlinear_term(angle, velocity, INERTIA, matrix, push)
    for j in range(JOINTS):
        share = c_p[j] / (c_v[j] + c_p[j])
        torque = moment_arm(angle[j], HALF_LENGTH, OFFSET) * TENSION
        push[j] = torque - share * (k_v[j] * elastic[j] + c_v[j] * velocity[j]) - push[j]
        rate[j] = velocity[j]
        rate[6 + j] = share * velocity[j] - k_v[j] * elastic[j] / (c_v[j] + c_p[j])
    factorise(matrix)
    solve_factorised(matrix, push)
    rate[3:6] = push


@compiled
def fill_jacobian(
    state: NDArray, k_v: NDArray, c_v: NDArray, c_p: NDArray, room: NDArray, slopes: NDArray
) -> None:
    """Write the rates' derivatives; `slopes` is (by state, of rate)."""
    rate = room[12:21]
    by_angle, by_velocity = room[21:30].reshape(3, 3), room[30:39].reshape(3, 3)
    fill_rate(state, k_v, c_v, c_p, room, rate)
    matrix, column = room[:9].reshape(3, 3), room[9:12]  # M is left factorised
    fill_slopes(state[:3], state[3:6], rate[3:6], INERTIA, by_angle, by_velocity)
    slopes[:] = 0.0
    for j in range(JOINTS):
        share = c_p[j] / (c_v[j] + c_p[j])
        by_angle[j, j] -= TENSION * moment_arm_slope(state[j], HALF_LENGTH, OFFSET)
        by_velocity[j, j] += share * c_v[j]
        slopes[3 + j, j] = 1.0
        slopes[3 + j, 6 + j] = share
        slopes[6 + j, 6 + j] = -k_v[j] / (c_v[j] + c_p[j])
    for j in range(JOINTS):
        share = c_p[j] / (c_v[j] + c_p[j])
        for part in range(3):
            for i in range(JOINTS):
                column[i] = 0.0
                if part == 0:
                    column[i] = -by_angle[i, j]
                elif part == 1:
                    column[i] = -by_velocity[i, j]
                elif i == j:
                    column[i] = -share * k_v[j]
            solve_factorised(matrix, column)
            slopes[3 * part + j, 3:6] = column


def start_state(q_ini: NDArray) -> NDArray[np.float64]:
    """The state at rest."""
    return np.concatenate([q_ini, np.zeros(6)])
