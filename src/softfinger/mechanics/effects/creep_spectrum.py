"""A free spectrum of retardation times: the law of creep in time, whatever its shape.

One narrow peak is a second retardation, a broad band a power of time. So the effects of creep share
this form, and the shape shows which of them it is.
"""

import math

import numpy as np

from softfinger.compiled import compiled
from softfinger.mechanics.effects.effect import FREE, Form, Setting, Values, positive
from softfinger.mechanics.forward.curve import KNOTS, combine, weigh_value
from softfinger.mechanics.forward.hooks import Hook
from softfinger.mechanics.forward.modes import LADDER, RATES, SPACING, WITH_LADDER
from softfinger.mechanics.forward.slot import LOG_K_V, Slot, declare
from softfinger.mechanics.forward.work import Linear, Model

PLACES = 6  # of the spectrum, even in the logarithm of time
SIZE = 0.3  # prior scale of the spectrum's whole compliance, as a share of 1/k_v


_SPECTRUM, _SHORTEST, _LONGEST = declare(
    spectrum=Slot(
        "law", "1", 0.0, "compliance for each e-fold of retardation time, as a share of 1/k_v"
    ),
    spectrum_shortest=Slot(
        "joint", "s", 0.1, "time at which that law begins", "positive", constant=True
    ),
    spectrum_longest=Slot(
        "joint", "s", 10.0, "time at which that law ends", "positive", constant=True
    ),
)


@compiled
def add_spectrum(model: Model, linear: Linear, j: int) -> None:
    """Elements at the ladder's rates, of the spectrum's compliance there."""
    soft = math.exp(-model.joint[j, LOG_K_V])
    shortest, longest = model.joint[j, _SHORTEST], model.joint[j, _LONGEST]
    for step in range(RATES.size):
        x = -math.log(RATES[step] * shortest) / math.log(longest / shortest)
        if not 0.0 <= x <= 1.0:
            continue
        weights, unit = weigh_value(x), soft * SPACING * RATES[step]
        gain = unit * combine(model.law[j, _SPECTRUM], weights)
        linear.gain[j, LADDER + step] += gain
        for c in model.columns[j]:
            change = unit * combine(model.d_law[c, j, _SPECTRUM], weights)
            change -= gain * model.d_joint[c, j, LOG_K_V]
            linear.d_gain[j, LADDER + step, c] += change


SPECTRUM = Hook("modes", add_spectrum, ("spectrum",), modes=WITH_LADDER)


def build_spectrum(setting: Setting) -> Form:
    """Build the free form, between two frames and twice the longest trial."""
    shortest, longest = 2 * setting.interval, 2 * setting.duration
    size = SIZE / np.log(longest / shortest)
    heights = tuple(
        positive(f"compliance_share_at_{k}", size, per="joint", floor=2e-3 * size, term=True)
        for k in range(1, PLACES + 1)
    )
    between_places = np.linspace(0.0, PLACES - 1.0, KNOTS)
    hats = np.maximum(0.0, 1.0 - np.abs(between_places - np.arange(PLACES)[:, None]))

    def spectrum(values: Values) -> dict:
        stacked = np.stack([np.asarray(values[p.name]) for p in heights], axis=-1)
        reach = {"spectrum_shortest": shortest, "spectrum_longest": longest}
        return {"spectrum": stacked @ hats, **reach}

    return Form(FREE, heights, spectrum, kin="creep_spectrum")
