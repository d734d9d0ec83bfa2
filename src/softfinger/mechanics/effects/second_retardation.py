"""More Voigt elements in series: a second time scale, or a free spectrum of retardation times."""

import numpy as np

from softfinger.mechanics.effects.effect import FREE, Effect, Form, Setting, Values, positive
from softfinger.mechanics.effects.effect import time_constant as between
from softfinger.mechanics.forward.curve import KNOTS

PLACES = 6  # of the spectrum, even in the logarithm of time


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
)
