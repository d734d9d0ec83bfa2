"""A free spectrum of retardation times: the law of creep in time, whatever its shape.

One narrow peak is a second retardation, a broad band a power of time. So the effects of creep share
this form, and the shape shows which of them it is.
"""

import math

import numpy as np

from softfinger.compiled import compiled
from softfinger.mechanics.effects.effect import FREE, Form, Setting, Values, positive
from softfinger.mechanics.forward.curve import KNOTS, combine, weigh_slope, weigh_value
from softfinger.mechanics.forward.hooks import Hook
from softfinger.mechanics.forward.modes import LADDER, RATES, SPACING, WITH_LADDER
from softfinger.mechanics.forward.slot import LOG_C_V, LOG_K_V, Slot, declare
from softfinger.mechanics.forward.work import Linear, Model

PLACES = 6  # of the spectrum, even in the logarithm of time
OWN_TIMES = (
    1e-3,
    1e3,
)  # of the trial's own c_v/k_v: where a spectrum that follows it begins and ends
SIZE = 0.3  # prior scale of the spectrum's whole compliance, as a share of 1/k_v


_SPECTRUM, _SHORTEST, _LONGEST, _FOLLOWS = declare(
    spectrum=Slot(
        "law", "1", 0.0, "compliance for each e-fold of retardation time, as a share of 1/k_v"
    ),
    spectrum_shortest=Slot(
        "joint", "s", 0.1, "time at which that law begins", "positive", constant=True
    ),
    spectrum_longest=Slot(
        "joint", "s", 10.0, "time at which that law ends", "positive", constant=True
    ),
    spectrum_follows=Slot(
        "joint", "1", 0.0, "1: those times are multiples of the trial's own c_v/k_v", constant=True
    ),
)


@compiled
def add_spectrum(model: Model, linear: Linear, j: int) -> None:
    """Elements at the ladder's rates, of the spectrum's compliance there."""
    soft = math.exp(-model.joint[j, LOG_K_V])
    shortest, longest = model.joint[j, _SHORTEST], model.joint[j, _LONGEST]
    follows, reach = model.joint[j, _FOLLOWS], math.log(longest / shortest)
    shift = follows * (model.joint[j, LOG_C_V] - model.joint[j, LOG_K_V])
    law = model.law[j, _SPECTRUM]
    for step in range(RATES.size):
        x = -(math.log(RATES[step] * shortest) + shift) / reach
        if not 0.0 <= x <= 1.0:
            continue
        weights, unit = weigh_value(x), soft * SPACING * RATES[step]
        gain, slope = unit * combine(law, weights), unit * combine(law, weigh_slope(x)) / reach
        linear.gain[j, LADDER + step] += gain
        for c in model.columns[j]:
            change = unit * combine(model.d_law[c, j, _SPECTRUM], weights)
            change -= gain * model.d_joint[c, j, LOG_K_V]
            d_shift = model.d_joint[c, j, LOG_C_V] - model.d_joint[c, j, LOG_K_V]
            linear.d_gain[j, LADDER + step, c] += change - slope * follows * d_shift


SPECTRUM = Hook("modes", add_spectrum, ("spectrum",), modes=WITH_LADDER)


def build_spectra(setting: Setting) -> list[Form]:
    """Build the free forms: at times that all trials share, or that follow each trial's own."""
    shared = 2 * setting.interval, 2 * setting.duration
    return [
        _build_form(FREE, shared, np.linspace(0.0, PLACES - 1.0, KNOTS), follows=False),
        _build_form(
            f"{FREE}_superposed", OWN_TIMES, np.linspace(-1.0, PLACES, KNOTS), follows=True
        ),
    ]


def _build_form(name: str, times: tuple[float, float], knots: np.ndarray, *, follows: bool) -> Form:
    """A spectrum between two times; at knots beyond its places it vanishes."""
    size = SIZE / np.log(times[1] / times[0])
    heights = tuple(
        positive(f"compliance_share_at_{k}", size, per="joint", floor=2e-3 * size, term=True)
        for k in range(1, PLACES + 1)
    )
    hats = np.maximum(0.0, 1.0 - np.abs(knots - np.arange(PLACES)[:, None]))

    def spectrum(values: Values) -> dict:
        stacked = np.stack([np.asarray(values[p.name]) for p in heights], axis=-1)
        return {
            "spectrum": stacked @ hats,
            "spectrum_shortest": times[0],
            "spectrum_longest": times[1],
            "spectrum_follows": float(follows),
        }

    return Form(name, heights, spectrum, kin="creep_spectrum")
