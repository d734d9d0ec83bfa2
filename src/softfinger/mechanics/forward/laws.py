"""The nonlinear dashpot of a joint, with all its partial derivatives."""

import math

from numpy.typing import NDArray

from softfinger.compiled import compiled
from softfinger.mechanics.forward.curve import combine, weigh_slope, weigh_value
from softfinger.mechanics.forward.slots import JOINT_SLOTS, LAWS

_SINH = JOINT_SLOTS.index("flow_sinh")
_POWER = JOINT_SLOTS.index("flow_power")
_REFERENCE = JOINT_SLOTS.index("flow_reference")
_YIELD = JOINT_SLOTS.index("yield_torque")
_WIDTH = JOINT_SLOTS.index("yield_width")
_JUMP = JOINT_SLOTS.index("yield_jump")
_REACH = JOINT_SLOTS.index("flow_reach")
_SOFTENING = JOINT_SLOTS.index("softening_flow")
_SOFTENING_TIME = JOINT_SLOTS.index("softening_time")
_FLOW_LAW = LAWS.index("flow_law")


@compiled
def soften(time: float, constant: float) -> tuple[float, float]:
    """How far a softening has come, 1 − e^{−t/T}, and its derivative by T; 0 before the start."""
    ratio = max(time, 0.0) / constant
    return -math.expm1(-ratio), -ratio * math.exp(-ratio) / constant


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
def flow_drive(
    value: NDArray, law: NDArray, time: float, torque: float, partial: NDArray
) -> tuple[float, float]:
    """The torque that the dashpot feels: power ∘ sinh ∘ threshold of the joint's torque.

    Each is the identity at its null: S(τ − τ_y) − S(−τ − τ_y) with the soft ramp S; sinh(b y)/b;
    y |y/reference|^b. All times exp(law of |τ|), over what softening leaves of the viscosity.
    Returns the drive and its slope; `partial` receives the derivatives by yield_torque,
    yield_width, flow_sinh, flow_power, the law, softening_flow and softening_time.
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
    x = abs(torque) / value[_REACH]
    eased, by_time = soften(time, value[_SOFTENING_TIME])
    thin = math.exp(combine(law[_FLOW_LAW], weigh_value(x))) / (1.0 - value[_SOFTENING] * eased)
    climb = combine(law[_FLOW_LAW], weigh_slope(x)) * math.copysign(1.0 / value[_REACH], torque)
    drive, chain = sheared * factor * thin, (1.0 + power) * factor * thin
    partial[0] *= chain * steep
    partial[1] *= chain * steep
    partial[2] = chain * by_b
    partial[3] = drive * math.log(ratio) if ratio > 0.0 else 0.0
    partial[4] = drive
    thinner = drive / (1.0 - value[_SOFTENING] * eased)
    partial[5], partial[6] = thinner * eased, thinner * value[_SOFTENING] * by_time
    return drive, chain * steep * slope + drive * climb


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
def flow_tangent(
    value: NDArray, change: NDArray, law_change: NDArray, torque: float, partial: NDArray
) -> float:
    """The change of `flow_drive` along a change of the slots, at fixed torque."""
    total = partial[0] * change[_YIELD] + partial[1] * change[_WIDTH]
    total += partial[2] * change[_SINH] + partial[3] * change[_POWER]
    total += partial[5] * change[_SOFTENING] + partial[6] * change[_SOFTENING_TIME]
    weights = weigh_value(abs(torque) / value[_REACH])
    return total + partial[4] * combine(law_change[_FLOW_LAW], weights)
