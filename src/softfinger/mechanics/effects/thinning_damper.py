"""A damper that thins: the torque of the Voigt damper rises less than its rate.

Torque ∝ rate^n where the torque is large, and in proportion where it is small (Ellis); free: the
rate is any smooth function of the damper's torque.

Ellis; in Bird, Armstrong and Hassager (1987), Dynamics of Polymeric Liquids 1, section 4.1.
"""

from softfinger.mechanics.effects.effect import Effect, Form, Setting, Values, positive
from softfinger.mechanics.effects.law import Law, free_form

BENDS = {"early": 0.05, "late": 0.3}  # of the usual load: torque from which it thins


def _build_form(name: str, setting: Setting) -> Form:
    power = positive(
        "thinning",
        1.0,
        per="joint",
        floor=2e-3,
        report={"exponent": lambda b, _: 1.0 / (1.0 + max(b, 0.0))},
    )

    def slots(values: Values) -> dict:
        reference = BENDS[name] * setting.torque
        return {"damper_power": values["thinning"], "damper_reference": reference}

    return Form(name, (power,), slots)


def _build_forms(setting: Setting) -> list[Form]:
    law = Law(
        "damper_law",
        "damper_torque_nm",
        setting.torque,
        1.0,
        terms=5,
        per="joint",
        kind="exponential",
    )
    free = free_form(law, {"damper_reference": setting.torque})
    return [*(_build_form(name, setting) for name in BENDS), free]


EFFECT = Effect(
    "thinning_damper", "the damper thins as its rate grows", "within_trial", _build_forms
)
