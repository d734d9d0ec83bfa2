"""Stiffness that changes with deflection: k_v (1 + b y²), k_v (1 + b |y|), k_v exp(b |y|), free."""

from softfinger.mechanics.effects.effect import Effect, Form, Setting, Values, positive
from softfinger.mechanics.effects.law import Law, free_form

SHAPES = {"square": ("stiffening_per_rad2", 2.0), "linear": ("stiffening_per_rad", 1.0),
          "exponential": ("stiffening_exponent_per_rad", 1.0)}  # fmt: skip


def _build_form(shape: str, measure: str) -> Form:
    name, sd = SHAPES[shape]

    def slots(values: Values) -> dict:
        return {
            f"stiffening_{shape}": values[name],
            "stiffening_measure": float(measure == "joint_angle"),
        }

    parameter = positive(name, sd, per="joint", floor=5e-4)
    return Form(f"{shape}_in_{measure}", (parameter,), slots)


def _build_forms(setting: Setting) -> list[Form]:
    forms = [_build_form(shape, m) for shape in SHAPES for m in ("elastic_angle", "joint_angle")]
    law = Law("spring_law", "elastic_angle_rad", setting.reach, 0.5, terms=5, per="joint")
    return [*forms, free_form(law, {"spring_reach": setting.reach})]


EFFECT = Effect(
    "strain_stiffening", "the joint gets stiffer as it bends", "within_trial", _build_forms
)
