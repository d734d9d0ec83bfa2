"""Stiffness or viscosity that falls while the trial runs, as heat or water comes in."""

from softfinger.mechanics.effects.effect import (
    Effect,
    Form,
    Setting,
    Values,
    positive,
    time_constant,
)

SLOTS = {"stiffness": "softening_elastic", "viscosity": "softening_flow"}


def _build_form(target: str, setting: Setting) -> Form:
    share = positive("softening_share", 0.2, per="joint", high=0.9, floor=5e-4)
    time = time_constant("softening_time_s", 5 * setting.interval, 3 * setting.duration, starts=3)

    def slots(values: Values) -> dict:
        return {
            SLOTS[target]: values["softening_share"],
            "softening_time": values["softening_time_s"],
        }

    return Form(target, (share, time), slots)


def _build_forms(setting: Setting) -> list[Form]:
    return [_build_form(target, setting) for target in SLOTS]


EFFECT = Effect(
    "softening_within_trial", "the joint softens while the trial runs", "within_trial",
    _build_forms,
)  # fmt: skip
