"""The linear modes of a joint.

Rates λ and gains g of x' = −λ x + g D, and their tangents.

mode 0   Voigt element          λ = k_v/c_v      g = 1/c_v          drive: torque − nonlinear part
mode 1   dashpot                λ = 0            g = 1/c_p          drive: flow of the torque
mode 2   free for an effect                                         drive: torque
mode 3   another of the same    where it needs two                  drive: torque
mode 4…  ladder                 fixed rates                         drive: torque

The ladder has 24 rates from 2e-5 to 2e3 per second, even in log λ (step 0.8), one of 0 and a fast
one: enough for any smooth creep of the fingers' times. Hooks give its modes their gains.
"""

import math

import numpy as np

from softfinger.compiled import compiled
from softfinger.mechanics.forward.hooks import MODES, call_modes
from softfinger.mechanics.forward.slot import LOG_C_P, LOG_C_V, LOG_K_V
from softfinger.mechanics.forward.work import Linear, Model

VOIGT, FLOW, OWN, OTHER, LADDER = range(5)
SPACING = 0.8
RATES = 2e-5 * np.exp(SPACING * np.arange(24))
FAST = 4.0 * RATES[-1]
"""The rate of a mode that represents a spring."""
WITH_OWN, WITH_OTHER, WITH_LADDER = OTHER, LADDER, LADDER + RATES.size + 2
"""How many modes a joint has that needs its own one, two of them, or the ladder as well."""


@compiled
def fill_modes(model: Model, linear: Linear, j: int) -> None:
    """Write joint j's modes λ, g and tangents."""
    value = model.joint[j]
    rate, gain, d_rate, d_gain = linear.rate[j], linear.gain[j], linear.d_rate[j], linear.d_gain[j]
    rate[:], gain[:], d_rate[:], d_gain[:] = 0.0, 0.0, 0.0, 0.0
    for mode in range(LADDER, rate.size):
        rate[mode] = ladder_rate(mode - LADDER)
    rate[VOIGT] = math.exp(value[LOG_K_V] - value[LOG_C_V])
    gain[VOIGT], gain[FLOW] = math.exp(-value[LOG_C_V]), math.exp(-value[LOG_C_P])
    for c in model.columns[j]:
        change = model.d_joint[c, j]
        d_rate[VOIGT, c] = rate[VOIGT] * (change[LOG_K_V] - change[LOG_C_V])
        d_gain[VOIGT, c] = -gain[VOIGT] * change[LOG_C_V]
        d_gain[FLOW, c] = -gain[FLOW] * change[LOG_C_P]
    for k in range(model.count[MODES]):
        call_modes(model.hook[MODES, k], model, linear, j)


@compiled
def ladder_rate(step: int) -> float:
    """Rate of a step of the ladder [1/s].

    After the even ones 0 and a fast one.
    """
    if step < RATES.size:
        return RATES[step]
    return 0.0 if step == RATES.size else FAST
