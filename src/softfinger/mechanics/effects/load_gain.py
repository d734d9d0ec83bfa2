"""A load cell's drifting gain scales all compliances."""

import numpy as np

from softfinger.mechanics.effects.effect import FREE, Effect, Form, Setting, Values, signed
from softfinger.mechanics.effects.law import Law

LEAST_TRIALS = 4


def _build_forms(setting: Setting) -> list[Form] | str:
    if setting.trials < LEAST_TRIALS:
        return "a drift over trials needs several trials"
    last = float(setting.number.max())
    gain = signed("gain_per_trial", 0.15 / last, low=-0.9 / last, floor=2e-4 / last)
    law = Law("gain", "trial_number", last, 0.1, terms=5, kind="exponential")

    def scale(log_gain: np.ndarray) -> dict:
        shift = -log_gain[:, None] * np.ones(setting.joints)
        return dict.fromkeys(("log_k_v", "log_c_v", "log_c_p"), shift)

    def linear(values: Values) -> dict:
        return scale(np.log1p(values["gain_per_trial"] * setting.number))

    def free(values: Values) -> dict:
        return scale(law.evaluate(values, setting.number))

    return [Form("linear", (gain,), linear), Form(FREE, law.parameters, free, law=law, linear=True)]


EFFECT = Effect(
    "load_gain", "the gain of the load cell drifts over the trials", "between_trials", _build_forms
)
