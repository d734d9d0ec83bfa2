"""Voigt element and dashpot of a joint.

Hooks bend them; all derivatives are given.

The spring's torque is k_v · free · factor: `free` begins as the elastic angle q_v, `factor` as 1,
and hooks change them. The scratch `spring` is (free, its slope by q_v, factor, its slopes by q_v
and by the joint angle q, and how far beyond τ/k_v its balance may lie), `d_spring` the changes of
free and factor. The dashpot's drive begins as the torque, the damper's factor as 1.
"""

import math

from numpy.typing import NDArray

from softfinger.compiled import compiled
from softfinger.mechanics.forward.hooks import (
    DAMPER,
    FLOW,
    SPRING,
    call_damper,
    call_flow,
    call_spring,
)
from softfinger.mechanics.forward.slot import LOG_K_V
from softfinger.mechanics.forward.work import NO, YES, Model, Work

FREE, STEEP, FACTOR, BY_ELASTIC, BY_ANGLE, LEAD = range(6)
D_FREE, D_FACTOR = range(2)
VALUE, SLOPE = range(2)
"""Of a pair that hooks change in turn."""


@compiled
def has_curved_voigt(model: Model) -> bool:
    """Whether the Voigt element is not linear."""
    return model.count[SPRING] + model.count[DAMPER] > 0


@compiled
def flow_drive(
    model: Model, work: Work, j: int, time: float, torque: float, row: NDArray
) -> tuple[float, float]:
    """The dashpot's torque, its slope and changes `row`."""
    drive = work.pair
    drive[VALUE], drive[SLOPE] = torque, 1.0
    for k in range(model.count[FLOW]):
        call_flow(model.hook[FLOW, k], model, j, time, torque, drive, row)
    return drive[VALUE], drive[SLOPE]


@compiled
def spring_torque(
    model: Model, work: Work, j: int, time: float, elastic: float, angle: float, tangents: bool
) -> tuple[float, float, float]:
    """The spring's torque, its slopes by q_v, q."""
    spring = work.spring
    spring[FREE], spring[STEEP], spring[FACTOR] = elastic, 1.0, 1.0
    spring[BY_ELASTIC], spring[BY_ANGLE], spring[LEAD] = 0.0, 0.0, 0.0
    if tangents:
        work.d_spring[:] = 0.0
    for k in range(model.count[SPRING]):
        call_spring(
            model.hook[SPRING, k], model, j, time, elastic, angle, spring, work.d_spring, tangents
        )
    stiffness = math.exp(model.joint[j, LOG_K_V])
    bent = stiffness * spring[FREE]
    return (
        bent * spring[FACTOR],
        stiffness * spring[STEEP] * spring[FACTOR] + bent * spring[BY_ELASTIC],
        bent * spring[BY_ANGLE],
    )


@compiled
def spring_tangent(model: Model, work: Work, j: int, c: int) -> float:
    """Change of `spring_torque` by a column, angles fixed."""
    free, factor = work.spring[FREE], work.spring[FACTOR]
    change = free * factor * model.d_joint[c, j, LOG_K_V]
    change += work.d_spring[D_FREE, c] * factor + free * work.d_spring[D_FACTOR, c]
    return math.exp(model.joint[j, LOG_K_V]) * change


@compiled
def voigt_torque(
    model: Model, work: Work, j: int, time: float, torque: float, elastic: float, angle: float
) -> tuple[float, float, float, float]:
    """What the Voigt element takes of its drive.

    τ − k_v q_v − F φ(F), where F = τ − spring torque is the damper's torque and φ its factor; the
    rate is F φ(F)/c_v. Returns it and its derivatives by torque, q_v and q.
    """
    spring, by_elastic, by_angle = spring_torque(model, work, j, time, elastic, angle, NO)
    damper = torque - spring
    thin, climb = _damper_factor(model, work, j, time, damper, work.none)
    stiffness = math.exp(model.joint[j, LOG_K_V])
    steep = thin + damper * climb
    extra = torque - stiffness * elastic - damper * thin
    return extra, 1.0 - steep, steep * by_elastic - stiffness, steep * by_angle


@compiled
def fill_voigt_tangents(
    model: Model, work: Work, j: int, time: float, torque: float, elastic: float, angle: float,
    row: NDArray,
) -> None:  # fmt: skip
    """Write the changes of `voigt_torque` at fixed angles."""
    damper = torque - spring_torque(model, work, j, time, elastic, angle, YES)[0]
    row[:] = 0.0
    thin, climb = _damper_factor(model, work, j, time, damper, row)
    stiffness, steep = math.exp(model.joint[j, LOG_K_V]), thin + damper * climb
    for c in model.columns[j]:
        stiffer = stiffness * elastic * model.d_joint[c, j, LOG_K_V]
        row[c] = steep * spring_tangent(model, work, j, c) - damper * row[c] - stiffer


@compiled
def _damper_factor(
    model: Model, work: Work, j: int, time: float, damper: float, row: NDArray
) -> tuple[float, float]:
    """The damper's factor, and its slope."""
    thin = work.pair
    thin[VALUE], thin[SLOPE] = 1.0, 0.0
    for k in range(model.count[DAMPER]):
        call_damper(model.hook[DAMPER, k], model, j, time, damper, thin, row)
    return thin[VALUE], thin[SLOPE]


@compiled
def solve_rest(
    model: Model, work: Work, j: int, time: float, torque: float, angle: float
) -> tuple[float, float, float]:
    """The elastic angle that balances a torque.

    Returns it, and its derivatives by the torque and by the joint angle.
    """
    elastic = torque / math.exp(model.joint[j, LOG_K_V])
    slope, turn = 1.0, 0.0
    for iteration in range(50):
        taken, slope, turn = spring_torque(model, work, j, time, elastic, angle, NO)
        step = (torque - taken) / slope
        if iteration == 0 and work.spring[LEAD] > 0.0 and torque != 0.0:
            step = math.copysign(work.spring[LEAD], torque)
        elastic += step
        if not abs(step) > 1e-15 * (1.0 + abs(elastic)):
            break
    return elastic, 1.0 / slope, -turn / slope
