"""A dashpot that flows only above a torque: by the excess (Bingham) or by the whole torque.

Under one constant load alone a threshold vanishes in c_p. It is tried all the same: beside a wire
whose moment arm changes, say, the joint's torque does not stay what it is.
"""

from softfinger.mechanics.effects.effect import Effect, Form, Setting, Values, positive


def _build_form(kind: str, setting: Setting) -> Form:
    threshold = positive(
        "threshold_nm",
        0.5 * setting.torque,
        high=2 * setting.torque,
        floor=1e-3 * setting.torque,
    )

    def slots(values: Values) -> dict:
        return {
            "yield_torque": values["threshold_nm"],
            "yield_width": 0.02 * setting.torque,
            "yield_jump": float(kind == "whole_torque"),
        }

    return Form(kind, (threshold,), slots, local=True)


def _build_forms(setting: Setting) -> list[Form]:
    return [_build_form(kind, setting) for kind in ("excess", "whole_torque")]


EFFECT = Effect(
    "yield_threshold", "the joint flows only above a torque", "within_trial", _build_forms
)
