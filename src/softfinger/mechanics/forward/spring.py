"""The nonlinear Voigt element of a joint, spring and damper, with all its partial derivatives."""

import math

from numpy.typing import NDArray

from softfinger.compiled import compiled
from softfinger.mechanics.forward.curve import combine, weigh_slope, weigh_value
from softfinger.mechanics.forward.laws import soften, softplus
from softfinger.mechanics.forward.modes import LOG_K_V
from softfinger.mechanics.forward.slots import JOINT_SLOTS, LAWS

_SQUARE = JOINT_SLOTS.index("stiffening_square")
_LINEAR = JOINT_SLOTS.index("stiffening_linear")
_EXPONENTIAL = JOINT_SLOTS.index("stiffening_exponential")
_MEASURE = JOINT_SLOTS.index("stiffening_measure")
_REACH = JOINT_SLOTS.index("spring_reach")
_PLAY = JOINT_SLOTS.index("play")
_PLAY_WIDTH = JOINT_SLOTS.index("play_width")
_SOFTENING = JOINT_SLOTS.index("softening_elastic")
_SOFTENING_TIME = JOINT_SLOTS.index("softening_time")
_POWER = JOINT_SLOTS.index("damper_power")
_REFERENCE = JOINT_SLOTS.index("damper_reference")
_SPRING_LAW, _DAMPER_LAW = LAWS.index("spring_law"), LAWS.index("damper_law")


@compiled
def spring_torque(
    value: NDArray, law: NDArray, time: float, elastic: float, angle: float
) -> tuple[float, float, float]:
    """The spring: k_v D(q_v) (1 + g(y)) (1 − s (1 − e^{−t/T})).

    g = b y² + b |y| + e^{b|y|} − 1 + law of |y|, where y = q_v, or the joint angle q where
    `stiffening_measure` is 1. D leaves out the play: S(q_v − p) − S(−q_v − p), S a soft ramp.
    Returns the torque and its derivatives by q_v and q.
    """
    measure = value[_MEASURE]
    strain = (1.0 - measure) * elastic + measure * angle
    sign, size = math.copysign(1.0, strain), abs(strain)
    growth, x = math.exp(value[_EXPONENTIAL] * size), size / value[_REACH]
    factor = value[_SQUARE] * size * size + value[_LINEAR] * size + growth
    factor += combine(law[_SPRING_LAW], weigh_value(x))
    slope = value[_LINEAR] + value[_EXPONENTIAL] * growth + 2.0 * value[_SQUARE] * size
    slope += combine(law[_SPRING_LAW], weigh_slope(x)) / value[_REACH]
    free, steep, _ = _leave_play(value, elastic)
    left = 1.0 - value[_SOFTENING] * soften(time, value[_SOFTENING_TIME])[0]
    stiffness = math.exp(value[LOG_K_V]) * left
    bent = stiffness * free * sign * slope
    return (
        stiffness * free * factor,
        stiffness * steep * factor + (1.0 - measure) * bent,
        measure * bent,
    )


@compiled
def spring_tangent(
    value: NDArray,
    change: NDArray,
    law: NDArray,
    law_change: NDArray,
    time: float,
    elastic: float,
    angle: float,
) -> float:
    """The change of `spring_torque` along a change of the slots, at fixed angles."""
    measure = value[_MEASURE]
    size = abs((1.0 - measure) * elastic + measure * angle)
    growth, weights = math.exp(value[_EXPONENTIAL] * size), weigh_value(size / value[_REACH])
    factor = value[_SQUARE] * size * size + value[_LINEAR] * size + growth
    factor += combine(law[_SPRING_LAW], weights)
    d_factor = change[_SQUARE] * size * size + change[_LINEAR] * size
    d_factor += change[_EXPONENTIAL] * size * growth + combine(law_change[_SPRING_LAW], weights)
    free, _, by_play = _leave_play(value, elastic)
    eased, by_time = soften(time, value[_SOFTENING_TIME])
    left = 1.0 - value[_SOFTENING] * eased
    d_left = -change[_SOFTENING] * eased - value[_SOFTENING] * by_time * change[_SOFTENING_TIME]
    change_of_torque = free * factor * (left * change[LOG_K_V] + d_left)
    change_of_torque += left * (free * d_factor + by_play * change[_PLAY] * factor)
    return math.exp(value[LOG_K_V]) * change_of_torque


@compiled
def _leave_play(value: NDArray, elastic: float) -> tuple[float, float, float]:
    """The elastic angle beyond the play, and its derivatives by that angle and the play."""
    play, width = value[_PLAY], value[_PLAY_WIDTH]
    if play == 0.0:
        return elastic, 1.0, -math.tanh(elastic / (2.0 * width))
    above, rise = softplus(elastic - play, width)
    below, fall = softplus(-elastic - play, width)
    return above - below, rise + fall, fall - rise


@compiled
def voigt_torque(
    value: NDArray, law: NDArray, time: float, torque: float, elastic: float, angle: float
) -> tuple[float, float, float, float]:
    """What the Voigt element takes away from a linear one's drive: τ − k_v q_v − F φ(F).

    F = τ − spring torque is the damper's torque and φ its thinning; the rate is F φ(F)/c_v.
    Returns it and its derivatives by torque, q_v and q.
    """
    spring, by_elastic, by_angle = spring_torque(value, law, time, elastic, angle)
    damper = torque - spring
    thin, climb = _thin(value, law, damper)
    stiffness = math.exp(value[LOG_K_V])
    steep = thin + damper * climb
    extra = torque - stiffness * elastic - damper * thin
    return extra, 1.0 - steep, steep * by_elastic - stiffness, steep * by_angle


@compiled
def voigt_tangent(
    value: NDArray,
    change: NDArray,
    law: NDArray,
    law_change: NDArray,
    time: float,
    torque: float,
    elastic: float,
    angle: float,
) -> float:
    """The change of `voigt_torque` along a change of the slots, at fixed torque and angles."""
    spring = spring_torque(value, law, time, elastic, angle)[0]
    damper = torque - spring
    thin, climb = _thin(value, law, damper)
    softer = spring_tangent(value, change, law, law_change, time, elastic, angle)
    ratio = damper / value[_REFERENCE]
    d_log = 0.5 * math.log1p(ratio * ratio) * change[_POWER]
    d_log += combine(law_change[_DAMPER_LAW], weigh_value(abs(ratio)))
    stiffer = math.exp(value[LOG_K_V]) * elastic * change[LOG_K_V]
    return (thin + damper * climb) * softer - damper * thin * d_log - stiffer


@compiled
def _thin(value: NDArray, law: NDArray, damper: float) -> tuple[float, float]:
    """The thinning (1 + (F/reference)²)^{b/2} e^{law of |F|}, and its slope."""
    power, reference = value[_POWER], value[_REFERENCE]
    ratio = damper / reference
    square = 1.0 + ratio * ratio
    bend = combine(law[_DAMPER_LAW], weigh_value(abs(ratio)))
    climb = combine(law[_DAMPER_LAW], weigh_slope(abs(ratio))) * math.copysign(1.0, ratio)
    thin = math.exp(0.5 * power * math.log(square) + bend)
    return thin, thin * (power * ratio / square + climb) / reference


@compiled
def solve_rest(
    value: NDArray, law: NDArray, time: float, torque: float, angle: float
) -> tuple[float, float, float]:
    """The elastic angle at which the spring balances a torque, at rest.

    Returns it, and its derivatives by the torque and by the joint angle.
    """
    elastic = torque / math.exp(value[LOG_K_V])
    if value[_PLAY] > 0.0 and torque != 0.0:
        elastic += math.copysign(value[_PLAY], torque)
    slope, turn = 1.0, 0.0
    for _ in range(50):
        taken, slope, turn = spring_torque(value, law, time, elastic, angle)
        step = (torque - taken) / slope
        elastic += step
        if not abs(step) > 1e-15 * (1.0 + abs(elastic)):
            break
    return elastic, 1.0 / slope, -turn / slope
