"""Friction along the wire that falls over the first trials, as the grease warms up."""

from collections.abc import Mapping

import numpy as np

from softfinger.api import Effect, Form, Law, Setting, positive, time_constant

LEAST_TRIALS = 6


def _build_forms(setting: Setting) -> list[Form] | str:
    if setting.trials < LEAST_TRIALS or setting.joints < 2:
        return "friction that warms up shows over several trials of several joints"
    friction = positive("cold_friction", 0.2, floor=2e-3)
    trials = time_constant("warm_up_trials", 1.0, 2.0 * setting.number.max(), starts=2)

    def slots(values: Mapping) -> dict:
        left = np.exp(-setting.number / float(values["warm_up_trials"]))
        return {"friction_constant": values["cold_friction"] * left}  # one value for each trial

    last = float(setting.number.max())
    law = Law("cold_friction_law", "trials_to_go", last, 0.1, terms=4, kind="sum")

    def free(values: Mapping) -> dict:
        return {"friction_constant": law.evaluate(values, last - setting.number)}

    return [
        Form("exponential", (friction, trials), slots),
        Form("free", law.parameters, free, law=law),  # any other way to fall
    ]


EFFECT = Effect(
    "friction_warm_up",
    "the wire's friction falls over the first trials",
    "between_trials",
    _build_forms,
)
