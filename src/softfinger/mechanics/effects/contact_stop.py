"""A joint that meets a stop: a spring that acts beyond an angle, hard, soft or hardening."""

import numpy as np

from softfinger.mechanics.effects.effect import Effect, Form, Parameter, Setting, Values, positive
from softfinger.mechanics.effects.law import Law, free_form

WIDTHS_RAD = {"hard": 0.01, "soft": 0.05}


def _build_form(kind: str, setting: Setting) -> Form:
    stiffness = float(np.median(setting.stiffness))
    spring = positive(
        "stop_stiffness_nm_per_rad",
        5 * stiffness,
        per="joint",
        floor=2e-3 * stiffness,
    )
    place = Parameter(
        "stop_share_of_reach",
        0.8,
        0.15,
        per="joint",
        low=0.05,
        high=1.0,
        starts=(0.6, 0.8, 0.92),
        report={"stop_angle_rad": lambda share, joint: share * setting.reach[joint]},
    )

    def slots(values: Values) -> dict:
        return {
            "stop_stiffness": values["stop_stiffness_nm_per_rad"],
            "stop_angle": values["stop_share_of_reach"] * setting.reach,
            "stop_width": WIDTHS_RAD[kind],
        }

    return Form(kind, (spring, place), slots)


def _build_forms(setting: Setting) -> list[Form]:
    forms = {kind: _build_form(kind, setting) for kind in WIDTHS_RAD}
    reach = 0.4 * setting.reach
    law = Law("stop_law", "depth_rad", reach, 0.7, terms=3, per="joint")
    return [*forms.values(), free_form(law, {"stop_reach": reach}, forms["soft"])]


EFFECT = Effect("contact_stop", "the joint meets a stop", "within_trial", _build_forms)
