"""The linear modes of a joint: rates λ and gains g of x' = −λ x + g D, and their tangents.

mode 0   Voigt element          λ = k_v/c_v      g = 1/c_v          drive: torque − nonlinear part
mode 1   dashpot                λ = 0            g = 1/c_p          drive: flow of the torque
mode 2   second Voigt element   λ = 1/T          g = J/T            drive: torque
mode 3…  springpot              fixed rates      weights            drive: torque

The springpot's creep rate t^{a−1}/Γ(a) = (sin πa/π) ∫ λ^{−a} e^{−λt} dλ becomes a trapezoidal sum
in log λ (step 0.8, 24 rates from 2e-5 to 2e3 per second). The rates below that range act as a
dashpot, those above as a spring, both summed exactly: a → 1 is the dashpot, a → 0 the spring. Its
creep compliance is within 6e-5 of t^a/Γ(1 + a), relatively, from 5 ms to 200 s. A spectrum of
retardation times has the same fixed rates.
"""

import math

import numpy as np
from numpy.typing import NDArray

from softfinger.compiled import compiled
from softfinger.mechanics.forward.curve import combine, weigh_value
from softfinger.mechanics.forward.slots import JOINT_SLOTS, LAWS

LOG_K_V, LOG_C_V, LOG_C_P, Q_INI = range(4)
_SECOND = JOINT_SLOTS.index("second_compliance")
_SECOND_SHARE = JOINT_SLOTS.index("second_share")
_SECOND_TIME = JOINT_SLOTS.index("second_time")
_POT = JOINT_SLOTS.index("springpot_compliance")
_POT_ELASTIC = JOINT_SLOTS.index("springpot_elastic_share")
_POT_FLOW = JOINT_SLOTS.index("springpot_flow_share")
_EXPONENT = JOINT_SLOTS.index("springpot_exponent")
_FLOW_SHARE = JOINT_SLOTS.index("flow_share")
_SHORTEST, _LONGEST = JOINT_SLOTS.index("spectrum_shortest"), JOINT_SLOTS.index("spectrum_longest")
_SPECTRUM = LAWS.index("spectrum")

VOIGT, FLOW, SECOND, SPRINGPOT = range(4)
_SPACING = 0.8
_RATES = 2e-5 * np.exp(_SPACING * np.arange(24))
_FAST = 4.0 * _RATES[-1]  # the mode that stands for the spring
MODES = SPRINGPOT + _RATES.size + 2
"""All modes of a joint, springpot included."""


@compiled
def springpot_weight(mode: int, exponent: float) -> tuple[float, float, float]:
    """λ, g of a springpot mode of unit compliance, and dg/da."""
    last, missing = _RATES.size, 1.0 - exponent
    if mode < last:
        reach = math.sin(math.pi * missing) / math.pi
        power = _SPACING * _RATES[mode] ** missing
        turn = -math.cos(math.pi * missing) - reach * math.log(_RATES[mode])
        return _RATES[mode], reach * power, turn * power
    if mode == last:  # all slower rates: a dashpot
        share, climb = _tail(missing)
        weight = share * _RATES[0] ** missing
        return 0.0, weight, -weight * (climb + math.log(_RATES[0]))
    share, climb = _tail(exponent)  # all faster rates: a spring
    weight = share * _FAST * _RATES[-1] ** -exponent
    return _FAST, weight, weight * (climb - math.log(_RATES[-1]))


@compiled
def _tail(x: float) -> tuple[float, float]:
    """Σ_{n ≥ 1} (sin πx/π) Δ e^{−n x Δ} = (sin πx/πx) xΔ/(e^{xΔ} − 1), and d log/dx; 1 at x = 0."""
    if x < 1e-4:  # by series, to rounding
        return 1.0 - _SPACING * x / 2.0, -_SPACING / 2.0 + (
            _SPACING**2 / 12.0 - math.pi**2 / 3.0
        ) * x
    growth = math.expm1(x * _SPACING)
    share = math.sin(math.pi * x) / math.pi * _SPACING / growth
    climb = math.pi / math.tan(math.pi * x) - _SPACING * (growth + 1.0) / growth
    return share, climb


@compiled
def fill_modes(value: NDArray, law: NDArray, rate: NDArray, gain: NDArray) -> None:
    """Write λ and g of one joint's modes (mode,) from its slots (slot,) and laws (law, knot)."""
    soft, thin = math.exp(-value[LOG_K_V]), math.exp(-value[LOG_C_P])
    rate[VOIGT] = math.exp(value[LOG_K_V] - value[LOG_C_V])
    gain[VOIGT] = math.exp(-value[LOG_C_V])
    rate[FLOW], gain[FLOW] = 0.0, value[_FLOW_SHARE] * thin
    if rate.size > SECOND:
        rate[SECOND] = 1.0 / value[_SECOND_TIME]
        gain[SECOND] = (value[_SECOND] + value[_SECOND_SHARE] * soft) * rate[SECOND]
    compliance = value[_POT] + value[_POT_ELASTIC] * soft + value[_POT_FLOW] * thin
    for mode in range(SPRINGPOT, rate.size):
        rate[mode], weight, _ = springpot_weight(mode - SPRINGPOT, value[_EXPONENT])
        gain[mode] = compliance * weight + soft * _read_spectrum(value, law, mode)


@compiled
def _read_spectrum(value: NDArray, law: NDArray, mode: int) -> float:
    """The gain, for a compliance 1/k_v of 1, that a spectrum gives to one of the fixed rates."""
    if mode - SPRINGPOT >= _RATES.size:
        return 0.0
    rate = _RATES[mode - SPRINGPOT]
    x = -math.log(rate * value[_SHORTEST]) / math.log(value[_LONGEST] / value[_SHORTEST])
    if not 0.0 <= x <= 1.0:
        return 0.0
    return combine(law[_SPECTRUM], weigh_value(x)) * _SPACING * rate


@compiled
def fill_mode_tangents(
    value: NDArray,
    change: NDArray,
    law: NDArray,
    law_change: NDArray,
    rate: NDArray,
    gain: NDArray,
    d_rate: NDArray,
    d_gain: NDArray,
) -> None:
    """Write the change of λ and g (mode,) along a change of slots (slot,) and laws (law, knot)."""
    soft, thin = math.exp(-value[LOG_K_V]), math.exp(-value[LOG_C_P])
    d_rate[:] = 0.0
    d_rate[VOIGT] = rate[VOIGT] * (change[LOG_K_V] - change[LOG_C_V])
    d_gain[VOIGT] = -gain[VOIGT] * change[LOG_C_V]
    d_gain[FLOW] = change[_FLOW_SHARE] * thin - gain[FLOW] * change[LOG_C_P]
    if rate.size > SECOND:
        slower = change[_SECOND_TIME] * rate[SECOND]
        d_share = change[_SECOND_SHARE] - value[_SECOND_SHARE] * change[LOG_K_V]
        d_rate[SECOND] = -rate[SECOND] * slower
        d_gain[SECOND] = (change[_SECOND] + d_share * soft) * rate[SECOND] - gain[SECOND] * slower
    compliance = value[_POT] + value[_POT_ELASTIC] * soft + value[_POT_FLOW] * thin
    d_elastic = change[_POT_ELASTIC] - value[_POT_ELASTIC] * change[LOG_K_V]
    d_flow = change[_POT_FLOW] - value[_POT_FLOW] * change[LOG_C_P]
    d_compliance = change[_POT] + d_elastic * soft + d_flow * thin
    for mode in range(SPRINGPOT, rate.size):
        _, weight, by_exponent = springpot_weight(mode - SPRINGPOT, value[_EXPONENT])
        d_gain[mode] = d_compliance * weight + compliance * by_exponent * change[_EXPONENT]
        d_gain[mode] += soft * _read_spectrum(value, law_change, mode)
        d_gain[mode] -= soft * _read_spectrum(value, law, mode) * change[LOG_K_V]
