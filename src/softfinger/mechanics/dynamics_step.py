"""One step of Rodas5P through the motion.

The equations of motion are those of `dynamics`.

A state is (q, q̇, q_v), one after the other; a row of `stages` is one state's increments at all
stages. With s = c_p/(c_v + c_p), the rows of `joint` are s k_v [N m/rad], s c_v [N m s/rad], s [1]
and k_v/(c_v + c_p) [1/s]. `half_length` is half the joint's length [m], NaN where the arm is
constant. `squares` (4, joint, joint) and `rows` (9 joint,) are scratch.
"""

from numpy.typing import NDArray

from softfinger.compiled import compiled
from softfinger.mechanics import rodas
from softfinger.mechanics.chain import fill_inertia_and_nonlinear_term, fill_slopes
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
    squares: NDArray,
    rows: NDArray,
) -> None:
    """One Rosenbrock step `state` → `after`, and stages."""
    n = state.size // 3
    inertia, by_angle, system, scratch = squares
    rate, right = rows[: 3 * n], rows[3 * n : 6 * n]
    push, drift, slack = rows[6 * n : 7 * n], rows[7 * n : 8 * n], rows[8 * n :]
    span = rodas.GAMMA * step
    _fill_rate(joint, coefficients, half_length, offset, tension, state, inertia, scratch, rate)
    fill_slopes(state[:n], state[n : 2 * n], rate[n : 2 * n], coefficients, by_angle, scratch)
    for j in range(n):
        slack[j] = span / (1.0 + span * joint[3, j])
        drift[j] = climb * offset
        if half_length == half_length:
            by_angle[j, j] -= tension * moment_arm_slope(state[j], half_length, offset)
            drift[j] = climb * moment_arm(state[j], half_length, offset)
        for m in range(n):
            system[j, m] = inertia[j, m] / span + scratch[j, m] + by_angle[j, m] * span
        system[j, j] += joint[1, j] + joint[0, j] * joint[2, j] * slack[j]
    factorise(system)
    for i in range(rodas.STAGES):
        if i > 0:
            _combine(state, _A, i, 1.0, stages, after)
            pull = tension + climb * _NODES[i] * step
            _fill_rate(
                joint, coefficients, half_length, offset, pull, after, scratch, scratch, rate
            )
        _combine(rate, _C, i, 1.0 / step, stages, right)
        for j in range(n):
            push[j] = step * _D[i] * drift[j] - joint[0, j] * right[2 * n + j] * slack[j]
            for m in range(n):
                push[j] += inertia[j, m] * right[n + m] - by_angle[j, m] * right[m] * span
        solve_factorised(system, push)
        for j in range(n):
            stages[j, i] = (right[j] + push[j]) * span
            stages[n + j, i] = push[j]
            stages[2 * n + j, i] = (right[2 * n + j] + joint[2, j] * push[j]) * slack[j]
    for k in range(3 * n):
        after[k] += stages[k, rodas.STAGES - 1]


@compiled
def _combine(
    start: NDArray, weights: NDArray, stage: int, scale: float, stages: NDArray, output: NDArray
) -> None:
    """Write start + scale · Σ weight · stage.

    The sum is over the stages before this one, and goes into `output`.
    """
    for k in range(start.size):
        total = 0.0
        for i in range(stage):
            total += weights[stage, i] * stages[k, i]
        output[k] = start[k] + scale * total


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
    """(q̇, q̈, q̇_v) into `rate`, M(q) into `inertia`."""
    n = state.size // 3
    push = rate[n : 2 * n]
    fill_inertia_and_nonlinear_term(state[:n], state[n : 2 * n], coefficients, inertia, push)
    for j in range(n):
        arm = offset if half_length != half_length else moment_arm(state[j], half_length, offset)
        resist = joint[0, j] * state[2 * n + j] + joint[1, j] * state[n + j]
        push[j] = arm * tension - resist - push[j]
        rate[j] = state[n + j]
        rate[2 * n + j] = joint[2, j] * state[n + j] - joint[3, j] * state[2 * n + j]
    factors[:] = inertia
    factorise(factors)
    solve_factorised(factors, push)
