"""One more Voigt element in series or two, or a spectrum."""

import math
from dataclasses import replace

from softfinger.compiled import compiled
from softfinger.mechanics.effects.creep_spectrum import (
    CREEP,
    SPECTRUM,
    build_spectra,
)
from softfinger.mechanics.effects.effect import (
    Effect,
    Form,
    Parameter,
    Setting,
    Values,
    positive,
)
from softfinger.mechanics.effects.effect import time_constant as between
from softfinger.mechanics.forward.hooks import Hook
from softfinger.mechanics.forward.modes import OTHER, OWN, WITH_OTHER, WITH_OWN
from softfinger.mechanics.forward.slot import LOG_C_V, LOG_K_V, Slot, declare
from softfinger.mechanics.forward.work import Linear, Model

_COMPLIANCE, _SHARE, _TIME, _OWN, _SLOW_SHARE, _SLOWER = declare(
    second_compliance=Slot("joint", "rad/(N m)", 0.0, "compliance of a second Voigt element"),
    second_share=Slot("joint", "1", 0.0, "the same, as a share of 1/k_v"),
    second_time=Slot("joint", "s", 1.0, "its retardation time", "positive"),
    second_own_time=Slot(
        "joint", "1", 0.0, "1: that time is in units of the joint's c_v/k_v", constant=True
    ),
    second_slow_share=Slot("joint", "1", 0.0, "share of it that a third, slower element has"),
    second_slower=Slot("joint", "1", 10.0, "how many times as slow that one is", "positive"),
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


@compiled
def split_element(model: Model, linear: Linear, j: int) -> None:
    """Move a share of that element to a slower one.

    `add_element` has filled its mode before.
    """
    value = model.joint[j]
    share, slower = value[_SLOW_SHARE], value[_SLOWER]
    rate, gain = linear.rate[j, OWN], linear.gain[j, OWN]
    linear.rate[j, OTHER], linear.gain[j, OTHER] = rate / slower, share * gain / slower
    linear.gain[j, OWN] = (1.0 - share) * gain
    for c in model.columns[j]:
        change = model.d_joint[c, j]
        longer, d_gain = change[_SLOWER] / slower, linear.d_gain[j, OWN, c]
        linear.d_rate[j, OTHER, c] = (linear.d_rate[j, OWN, c] - rate * longer) / slower
        d_part = share * d_gain + change[_SLOW_SHARE] * gain
        linear.d_gain[j, OTHER, c] = (d_part - share * gain * longer) / slower
        linear.d_gain[j, OWN, c] = d_gain - d_part


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
        _add_slower(Form("two_elements", (share, time), proportional)),
    ]
    if setting.trials > 1:
        forms.append(Form("in_own_time", (share, time), own_time))
        forms.append(_add_slower(Form("two_elements_in_own_time", (share, time), own_time)))
    return [*forms, *build_spectra(setting)]


def _add_slower(form: Form) -> Form:
    """Give a form a slower element (generalised Voigt model)."""
    slow = Parameter("slow_share", 0.5, 0.2, low=0.05, high=0.95, starts=(0.5,))
    slower = replace(between("slower_by", 2.0, 100.0), starts=(math.log(10.0),))

    def slots(values: Values) -> dict:
        more = {"second_slow_share": values["slow_share"], "second_slower": values["slower_by"]}
        return form.slots(values) | more

    return replace(form, parameters=(*form.parameters, slow, slower), slots=slots)


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
        Hook("modes", split_element, ("second_slow_share",), modes=WITH_OTHER),
        SPECTRUM,
    ),
    place=CREEP,
)
