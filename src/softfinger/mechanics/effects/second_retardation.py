"""More Voigt elements in series, or a spectrum."""

import math

from softfinger.compiled import compiled
from softfinger.mechanics.effects.creep_spectrum import (
    CREEP,
    SPECTRUM,
    build_spectra,
)
from softfinger.mechanics.effects.effect import Effect, Form, Setting, Values, positive
from softfinger.mechanics.effects.effect import time_constant as between
from softfinger.mechanics.forward.hooks import Hook
from softfinger.mechanics.forward.modes import OWN, WITH_OWN
from softfinger.mechanics.forward.slot import LOG_C_V, LOG_K_V, Slot, declare
from softfinger.mechanics.forward.work import Linear, Model

_COMPLIANCE, _SHARE, _TIME, _OWN = declare(
    second_compliance=Slot("joint", "rad/(N m)", 0.0, "compliance of a second Voigt element"),
    second_share=Slot("joint", "1", 0.0, "the same, as a share of 1/k_v"),
    second_time=Slot("joint", "s", 1.0, "its retardation time", "positive"),
    second_own_time=Slot(
        "joint", "1", 0.0, "1: that time is in units of the joint's c_v/k_v", constant=True
    ),
)


@compiled
def add_element(model: Model, linear: Linear, j: int) -> None:
    """One more Voigt element: λ = 1/T, g = J/T."""
    value, soft = model.joint[j], math.exp(-model.joint[j, LOG_K_V])
    rate = math.exp(-value[_OWN] * (value[LOG_C_V] - value[LOG_K_V])) / value[_TIME]
    gain = (value[_COMPLIANCE] + value[_SHARE] * soft) * rate
    linear.rate[j, OWN], linear.gain[j, OWN] = rate, gain
    for c in model.columns[j]:
        change = model.d_joint[c, j]
        slower = change[_TIME] / value[_TIME]
        slower += value[_OWN] * (change[LOG_C_V] - change[LOG_K_V])
        d_share = change[_SHARE] - value[_SHARE] * change[LOG_K_V]
        linear.d_rate[j, OWN, c] = -rate * slower
        linear.d_gain[j, OWN, c] = (change[_COMPLIANCE] + d_share * soft) * rate - gain * slower


def _build_forms(setting: Setting) -> list[Form]:
    share = positive("compliance_share", 0.3, per="joint", floor=5e-4)
    time = between("retardation_time_s", 5 * setting.shortest, 2 * setting.duration, starts=4)

    def own_compliance(values: Values) -> dict:
        compliance = values["compliance_share"] / setting.stiffness
        return {"second_compliance": compliance, "second_time": values["retardation_time_s"]}

    def proportional(values: Values) -> dict:
        return {
            "second_share": values["compliance_share"],
            "second_time": values["retardation_time_s"],
        }

    def own_time(values: Values) -> dict:
        time = values["retardation_time_s"] / setting.own_time
        share = {"second_share": values["compliance_share"]}
        return {**share, "second_time": time, "second_own_time": 1.0}

    forms = [
        Form("proportional", (share, time), proportional),
        Form("own_compliance", (share, time), own_compliance),
    ]
    if setting.trials > 1:
        forms.append(Form("in_own_time", (share, time), own_time))
    return [*forms, *build_spectra(setting)]


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
        SPECTRUM,
    ),
    place=CREEP,
)
