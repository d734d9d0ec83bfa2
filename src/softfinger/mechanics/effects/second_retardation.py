"""More Voigt elements in series, or a spectrum."""

import math

import numpy as np

from softfinger.compiled import compiled
from softfinger.mechanics.effects.effect import FREE, Effect, Form, Setting, Values, positive
from softfinger.mechanics.effects.effect import time_constant as between
from softfinger.mechanics.forward.curve import KNOTS, combine, weigh_value
from softfinger.mechanics.forward.hooks import Hook
from softfinger.mechanics.forward.modes import LADDER, OWN, RATES, SPACING, WITH_LADDER, WITH_OWN
from softfinger.mechanics.forward.slot import LOG_K_V, Slot, declare
from softfinger.mechanics.forward.work import Linear, Model

PLACES = 6  # of the spectrum, even in the logarithm of time


_COMPLIANCE, _SHARE, _TIME, _SPECTRUM, _SHORTEST, _LONGEST = declare(
    second_compliance=Slot("joint", "rad/(N m)", 0.0, "compliance of a second Voigt element"),
    second_share=Slot("joint", "1", 0.0, "the same, as a share of 1/k_v"),
    second_time=Slot("joint", "s", 1.0, "its retardation time", "positive"),
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
def add_element(model: Model, linear: Linear, j: int) -> None:
    """One more Voigt element.

    λ = 1/T, g = J/T.
    """
    value, soft = model.joint[j], math.exp(-model.joint[j, LOG_K_V])
    rate = 1.0 / value[_TIME]
    gain = (value[_COMPLIANCE] + value[_SHARE] * soft) * rate
    linear.rate[j, OWN], linear.gain[j, OWN] = rate, gain
    for c in model.columns[j]:
        change = model.d_joint[c, j]
        slower = change[_TIME] * rate
        d_share = change[_SHARE] - value[_SHARE] * change[LOG_K_V]
        linear.d_rate[j, OWN, c] = -rate * slower
        linear.d_gain[j, OWN, c] = (change[_COMPLIANCE] + d_share * soft) * rate - gain * slower


@compiled
def add_spectrum(model: Model, linear: Linear, j: int) -> None:
    """Elements at the ladder's rates, by a spectrum."""
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


def _build_forms(setting: Setting) -> list[Form]:
    share = positive("compliance_share", 0.3, per="joint", floor=5e-4)
    time = between("retardation_time_s", 5 * setting.interval, 2 * setting.duration, starts=4)

    def own_compliance(values: Values) -> dict:
        compliance = values["compliance_share"] / setting.stiffness
        return {"second_compliance": compliance, "second_time": values["retardation_time_s"]}

    def proportional(values: Values) -> dict:
        return {
            "second_share": values["compliance_share"],
            "second_time": values["retardation_time_s"],
        }

    shortest, longest = 2 * setting.interval, 2 * setting.duration
    size = 0.3 / np.log(longest / shortest)
    heights = [
        positive(f"compliance_share_at_{k}", size, per="joint", floor=2e-3 * size, term=True)
        for k in range(1, PLACES + 1)
    ]
    between_places = np.linspace(0.0, PLACES - 1.0, KNOTS)
    hats = np.maximum(0.0, 1.0 - np.abs(between_places - np.arange(PLACES)[:, None]))

    def spectrum(values: Values) -> dict:
        stacked = np.stack([np.asarray(values[p.name]) for p in heights], axis=-1)
        reach = {"spectrum_shortest": shortest, "spectrum_longest": longest}
        return {"spectrum": stacked @ hats, **reach}

    return [
        Form("proportional", (share, time), proportional),
        Form("own_compliance", (share, time), own_compliance),
        Form(FREE, tuple(heights), spectrum),
    ]


EFFECT = Effect(
    "second_retardation",
    "the joint relaxes on a second, longer time scale",
    "within_trial",
    _build_forms,
    hooks=(
        Hook(
            "modes",
            add_element,
            ("second_compliance", "second_share"),
            modes=WITH_OWN,
        ),
        Hook("modes", add_spectrum, ("spectrum",), modes=WITH_LADDER),
    ),
)
