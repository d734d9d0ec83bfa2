"""Stiffness that grows with deflection: k_v (1 + b y²), k_v (1 + b |y|) or k_v exp(b |y|)."""

from softfinger.mechanics.effects.effect import Effect, Form, Setting, Values, positive

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
    return [_build_form(shape, m) for shape in SHAPES for m in ("elastic_angle", "joint_angle")]


EFFECT = Effect(
    "strain_stiffening", "the joint gets stiffer as it bends", "within_trial", _build_forms
)
