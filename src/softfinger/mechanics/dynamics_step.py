"""One step of Rodas5P through the equations of motion of `dynamics`.

The states are rows (q, q̇, q_v); a row of `joint` holds k_v, c_v, s = c_p/(c_v + c_p) and
k_v/(c_v + c_p). `half_length` is half the joint's length [m], NaN where the arm is constant.
"""

import numpy as np
from numpy.typing import NDArray

from softfinger.mechanics import rodas
from softfinger.mechanics.chain import fill_inertia_and_nonlinear_term, fill_slopes
from softfinger.mechanics.compiled import compiled
from softfinger.mechanics.linear import factorise, solve_factorised
from softfinger.mechanics.wires import moment_arm, moment_arm_slope

_A, _C, _D, _NODES = rodas.A, rodas.C, rodas.D, rodas.NODES


@compiled
def fill_stages(
    joint: NDArray,
    coefficients: NDArray,
    half_length: float,
    offset: float,
    tension: float,
    climb: float,
    step: float,
    state: NDArray,
    after: NDArray,
    stages: NDArray,
    work: NDArray,
) -> None:
    """One Rosenbrock step from `state` to `after`, with its stage increments."""
    n = state.shape[1]
    k_v, c_v, share, relax = joint
    inertia, by_angle, system, scratch = work
    push, rate = np.empty(n), np.empty((3, n))
    drift, right = np.empty(n), np.empty((3, n))
    gain = 1.0 / (rodas.GAMMA * step)
    for i in range(rodas.STAGES):
        combine(state, _A[i], 1.0, stages, i, after)
        now = tension + climb * _NODES[i] * step
        if i == 0:
            _fill_rate(joint, coefficients, half_length, offset, now, after, inertia, system, rate)
            fill_slopes(state[0], state[1], rate[1], coefficients, by_angle, scratch)
            for j in range(n):
                if half_length == half_length:
                    by_angle[j, j] -= now * moment_arm_slope(state[0, j], half_length, offset)
                    drift[j] = climb * moment_arm(state[0, j], half_length, offset)
                else:
                    drift[j] = climb * offset
            for j in range(n):
                for m in range(n):
                    by_angle[j, m] *= -1.0
                    system[j, m] = gain * inertia[j, m] + scratch[j, m] - by_angle[j, m] / gain
            for j in range(n):
                spring = share[j] * k_v[j]
                system[j, j] += share[j] * c_v[j] + spring * share[j] / (gain + relax[j])
            factorise(system)
        else:
            _fill_rate(joint, coefficients, half_length, offset, now, after, scratch, scratch, rate)
        combine(rate, _C[i], 1.0 / step, stages, i, right)
        for j in range(n):
            spring = share[j] * k_v[j]
            push[j] = step * _D[i] * drift[j] - spring * right[2, j] / (gain + relax[j])
            for m in range(n):
                push[j] += inertia[j, m] * right[1, m] + by_angle[j, m] * right[0, m] / gain
        solve_factorised(system, push)
        for j in range(n):
            stages[i, 1, j] = push[j]
            stages[i, 0, j] = (right[0, j] + push[j]) / gain
            stages[i, 2, j] = (right[2, j] + share[j] * push[j]) / (gain + relax[j])
    for row in range(3):
        for j in range(n):
            after[row, j] += stages[rodas.STAGES - 1, row, j]


@compiled
def combine(
    start: NDArray, weights: NDArray, scale: float, stages: NDArray, count: int, output: NDArray
) -> None:
    """Write start + scale · Σ over the first `count` stages of weight · stage into `output`."""
    for row in range(start.shape[0]):
        for j in range(start.shape[1]):
            total = 0.0
            for i in range(count):
                total += weights[i] * stages[i, row, j]
            output[row, j] = start[row, j] + scale * total


@compiled
def _fill_rate(
    joint: NDArray,
    coefficients: NDArray,
    half_length: float,
    offset: float,
    tension: float,
    state: NDArray,
    inertia: NDArray,
    factors: NDArray,
    rate: NDArray,
) -> None:
    """The equations of motion: (q̇, q̈, q̇_v) into `rate`, M(q) into `inertia`."""
    n = state.shape[1]
    k_v, c_v, share, relax = joint
    fill_inertia_and_nonlinear_term(state[0], state[1], coefficients, inertia, rate[1])
    for j in range(n):
        arm = offset if half_length != half_length else moment_arm(state[0, j], half_length, offset)
        resist = share[j] * (k_v[j] * state[2, j] + c_v[j] * state[1, j])
        rate[0, j] = state[1, j]
        rate[1, j] = arm * tension - resist - rate[1, j]
        rate[2, j] = share[j] * state[1, j] - relax[j] * state[2, j]
    factors[:] = inertia
    factorise(factors)
    solve_factorised(factors, rate[1])
