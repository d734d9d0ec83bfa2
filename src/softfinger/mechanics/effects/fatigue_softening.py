"""Parameters that drift with the trials done."""

import numpy as np

from softfinger.mechanics.effects.effect import (
    FREE,
    Effect,
    Form,
    Setting,
    Values,
    positive,
    time_constant,
)
from softfinger.mechanics.effects.law import ALIKE, Law, make_alike

LEAST_TRIALS = 4
TARGETS = {
    "stiffness": ("log_k_v",),
    "viscosity": ("log_c_v", "log_c_p"),
    "everything": ("log_k_v", "log_c_v", "log_c_p"),
}


def _build_form(law: str, target: str, setting: Setting) -> Form:
    last = setting.number.max()
    share = positive("softening_share", 0.2, per="joint", high=0.9, floor=2e-4)
    memory = time_constant("softening_trials", 1.0, 2.0 * last, starts=2)

    def progress(values: Values) -> np.ndarray:
        if law == "linear":
            return setting.number / last
        count = setting.number / float(values["softening_trials"])
        if law == "exponential":
            return -np.expm1(-count)
        end = last / float(values["softening_trials"])
        return np.log1p(count) / np.log1p(end)

    def slots(values: Values) -> dict:
        drift = np.log1p(-values["softening_share"][None, :] * progress(values)[:, None])
        return dict.fromkeys(TARGETS[target], drift)

    parameters = (share,) if law == "linear" else (share, memory)
    return Form(f"{law}_{target}", parameters, slots)


def _build_free_form(target: str, setting: Setting, *, alike: bool) -> Form:
    last = float(setting.number.max())
    law = Law("drift", "trial_number", last, 0.15, terms=5, per="joint", kind="exponential")
    law, name = (make_alike(law), ALIKE) if alike else (law, FREE)

    def slots(values: Values) -> dict:
        drift = np.atleast_2d(law.evaluate(values, setting.number)).T
        return dict.fromkeys(TARGETS[target], drift)

    return Form(f"{name}_{target}", law.parameters, slots, law=law, linear=True)


def _build_forms(setting: Setting) -> list[Form] | str:
    if setting.trials < LEAST_TRIALS:
        return "a drift over trials needs several trials"
    laws = ("linear", "exponential", "logarithmic")
    forms = [_build_form(law, target, setting) for target in TARGETS for law in laws]
    shared = (False, True) if setting.joints > 1 else (False,)
    free = [_build_free_form(t, setting, alike=a) for a in shared for t in TARGETS]
    return [*forms, *free]


EFFECT = Effect(
    "fatigue_softening",
    "the joint softens with the number of trials done",
    "between_trials",
    _build_forms,
)
