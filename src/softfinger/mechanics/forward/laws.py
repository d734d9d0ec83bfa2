"""The nonlinear spring and the nonlinear dashpot of a joint, with all their partial derivatives."""

import math

from numpy.typing import NDArray

from softfinger.mechanics.compiled import compiled
from softfinger.mechanics.forward.modes import LOG_K_V
from softfinger.mechanics.forward.slots import JOINT_SLOTS

_SQUARE = JOINT_SLOTS.index("stiffening_square")
_LINEAR = JOINT_SLOTS.index("stiffening_linear")
_EXPONENTIAL = JOINT_SLOTS.index("stiffening_exponential")
_MEASURE = JOINT_SLOTS.index("stiffening_measure")
_SINH = JOINT_SLOTS.index("flow_sinh")
_POWER = JOINT_SLOTS.index("flow_power")
_REFERENCE = JOINT_SLOTS.index("flow_reference")
_YIELD = JOINT_SLOTS.index("yield_torque")
_WIDTH = JOINT_SLOTS.index("yield_width")
_JUMP = JOINT_SLOTS.index("yield_jump")


@compiled
def softplus(x: float, width: float) -> tuple[float, float]:
    """A ramp max(x, 0) that sets in over `width`, and its slope."""
    ratio = x / width
    if ratio > 0.0:
        tail = math.exp(-ratio)
        return x + width * math.log1p(tail), 1.0 / (1.0 + tail)
    tail = math.exp(ratio)
    return width * math.log1p(tail), tail / (1.0 + tail)


@compiled
def spring_torque(value: NDArray, elastic: float, angle: float) -> tuple[float, float, float]:
    """What the spring adds to k_v q_v: k_v q_v g(y), g = b y², b |y| or e^{b|y|} − 1, or their sum.

    y = q_v, or the joint angle q where `stiffening_measure` is 1. Returns the torque and its
    derivatives by q_v and q.
    """
    stiffness, measure = math.exp(value[LOG_K_V]), value[_MEASURE]
    strain = (1.0 - measure) * elastic + measure * angle
    sign, size = math.copysign(1.0, strain), abs(strain)
    growth = math.exp(value[_EXPONENTIAL] * size)
    factor = value[_SQUARE] * size * size + value[_LINEAR] * size + (growth - 1.0)
    slope = value[_LINEAR] + value[_EXPONENTIAL] * growth + 2.0 * value[_SQUARE] * size
    bent = stiffness * elastic * sign * slope
    torque = stiffness * elastic * factor
    return torque, stiffness * factor + (1.0 - measure) * bent, measure * bent


@compiled
def spring_tangent(value: NDArray, change: NDArray, elastic: float, angle: float) -> float:
    """The change of `spring_torque` along a change of the slots, at fixed angles."""
    stiffness, measure = math.exp(value[LOG_K_V]), value[_MEASURE]
    size = abs((1.0 - measure) * elastic + measure * angle)
    growth = math.exp(value[_EXPONENTIAL] * size)
    factor = value[_SQUARE] * size * size + value[_LINEAR] * size + (growth - 1.0)
    change_of_factor = change[_SQUARE] * size * size + change[_LINEAR] * size
    change_of_factor += change[_EXPONENTIAL] * size * growth
    return stiffness * elastic * (factor * change[LOG_K_V] + change_of_factor)


@compiled
def flow_drive(value: NDArray, torque: float, partial: NDArray) -> tuple[float, float]:
    """The torque that the dashpot feels: power ∘ sinh ∘ threshold of the joint's torque.

    Each is the identity at its null: S(τ − τ_y) − S(−τ − τ_y) with the soft ramp S; sinh(b y)/b;
    y |y/reference|^b. Returns the drive and its slope; `partial` receives the derivatives by
    yield_torque, yield_width, flow_sinh and flow_power.
    """
    threshold, slope, partial[0], partial[1] = _threshold(value, torque)
    b = value[_SINH]
    bent = b * threshold
    if abs(bent) < 1e-3:  # by its series: exact to rounding, and regular at b = 0
        square = bent * bent
        sheared = threshold * (1.0 + square / 6.0 * (1.0 + square / 20.0))
        steep = 1.0 + square / 2.0 * (1.0 + square / 12.0)
        by_b = threshold * threshold * bent / 3.0 * (1.0 + square / 10.0)
    else:
        sheared, steep = math.sinh(bent) / b, math.cosh(bent)
        by_b = (threshold * steep - sheared) / b
    power, reference = value[_POWER], value[_REFERENCE]
    ratio = abs(sheared) / reference
    factor = ratio**power if ratio > 0.0 or power == 0.0 else 0.0
    chain = (1.0 + power) * factor
    partial[0] *= chain * steep
    partial[1] *= chain * steep
    partial[2] = chain * by_b
    partial[3] = sheared * factor * math.log(ratio) if ratio > 0.0 else 0.0
    return sheared * factor, chain * steep * slope


@compiled
def _threshold(value: NDArray, torque: float) -> tuple[float, float, float, float]:
    """The threshold, its slope, and its derivatives by its torque and its width."""
    limit, width = value[_YIELD], value[_WIDTH]
    if limit == 0.0:
        return torque, 1.0, -math.tanh(torque / (2.0 * width)) * (1.0 - value[_JUMP]), 0.0
    above, rise = softplus(torque - limit, width)
    below, fall = softplus(-torque - limit, width)
    gate = value[_JUMP] * limit
    rise_slope, fall_slope = rise * (1.0 - rise) / width, fall * (1.0 - fall) / width
    drive = above - below + gate * (rise - fall)
    slope = rise + fall + gate * (rise_slope + fall_slope)
    by_limit = fall - rise + value[_JUMP] * (rise - fall) - gate * (rise_slope - fall_slope)
    up, down = (torque - limit) / width, (-torque - limit) / width
    by_width = (above - up * width * rise - below + down * width * fall) / width
    by_width -= gate * (up * rise_slope - down * fall_slope)
    return drive, slope, by_limit, by_width


@compiled
def flow_tangent(change: NDArray, partial: NDArray) -> float:
    """The change of `flow_drive` along a change of the slots, at fixed torque."""
    total = partial[0] * change[_YIELD] + partial[1] * change[_WIDTH]
    return total + partial[2] * change[_SINH] + partial[3] * change[_POWER]


@compiled
def solve_rest(value: NDArray, torque: float, angle: float) -> tuple[float, float, float]:
    """The elastic angle at which the spring balances a torque, at rest: k_v x + n(x) = torque.

    Returns it, and its derivatives by the torque and by the joint angle.
    """
    stiffness = math.exp(value[LOG_K_V])
    elastic = torque / stiffness
    slope, turn = stiffness, 0.0
    for _ in range(50):
        extra, by_elastic, turn = spring_torque(value, elastic, angle)
        slope = stiffness + by_elastic
        step = (torque - stiffness * elastic - extra) / slope
        elastic += step
        if not abs(step) > 1e-15 * (1.0 + abs(elastic)):
            break
    return elastic, 1.0 / slope, -turn / slope
