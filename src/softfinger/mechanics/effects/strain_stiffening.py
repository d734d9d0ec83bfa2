"""Stiffness that changes with deflection.

k_v (1 + b y²), k_v (1 + b |y|), k_v exp(b |y|), free.
"""

import math

from numpy.typing import NDArray

from softfinger.compiled import compiled
from softfinger.mechanics.effects.effect import Effect, Form, Setting, Values, positive
from softfinger.mechanics.effects.law import Law, list_free_forms
from softfinger.mechanics.forward.curve import combine, weigh_slope, weigh_value
from softfinger.mechanics.forward.hooks import Hook
from softfinger.mechanics.forward.slot import Slot, declare
from softfinger.mechanics.forward.spring import BY_ANGLE, BY_ELASTIC, D_FACTOR, FACTOR
from softfinger.mechanics.forward.work import Model

SHAPES = {"square": ("stiffening_per_rad2", 2.0), "linear": ("stiffening_per_rad", 1.0),
          "exponential": ("stiffening_exponent_per_rad", 1.0)}  # fmt: skip


_SQUARE, _LINEAR, _EXPONENTIAL, _MEASURE, _LAW, _REACH = declare(
    stiffening_square=Slot("joint", "rad^-2", 0.0, "k_v (1 + b y²)"),
    stiffening_linear=Slot("joint", "rad^-1", 0.0, "k_v (1 + b |y|)"),
    stiffening_exponential=Slot("joint", "rad^-1", 0.0, "k_v exp(b |y|)"),
    stiffening_measure=Slot(
        "joint", "1", 0.0, "y = elastic angle q_v at 0, joint angle q at 1", constant=True
    ),
    spring_law=Slot("law", "1", 0.0, "k_v (1 + law), a law of |y|"),
    spring_reach=Slot("joint", "rad", 1.0, "|y| at which that law ends", "positive", constant=True),
)


@compiled
def stiffen(
    model: Model, j: int, time: float, elastic: float, angle: float, spring: NDArray,
    d_spring: NDArray, tangents: bool,
) -> None:  # fmt: skip
    """The stiffness times its change with deflection.

    The change is b y² + b |y| + e^{b|y|} + law of |y|.
    """
    value, law = model.joint[j], model.law[j, _LAW]
    measure = value[_MEASURE]
    strain = (1.0 - measure) * elastic + measure * angle
    sign, size = math.copysign(1.0, strain), abs(strain)
    growth, weights = math.exp(value[_EXPONENTIAL] * size), weigh_value(size / value[_REACH])
    factor = value[_SQUARE] * size * size + value[_LINEAR] * size + growth + combine(law, weights)
    slope = value[_LINEAR] + value[_EXPONENTIAL] * growth + 2.0 * value[_SQUARE] * size
    slope += combine(law, weigh_slope(size / value[_REACH])) / value[_REACH]
    before, slope = spring[FACTOR], slope * sign
    spring[FACTOR] *= factor
    spring[BY_ELASTIC] = factor * spring[BY_ELASTIC] + before * (1.0 - measure) * slope
    spring[BY_ANGLE] = factor * spring[BY_ANGLE] + before * measure * slope
    if tangents:
        for c in model.columns[j]:
            change = model.d_joint[c, j]
            d_factor = change[_SQUARE] * size * size + change[_LINEAR] * size
            d_factor += change[_EXPONENTIAL] * size * growth
            d_factor += combine(model.d_law[c, j, _LAW], weights)
            d_spring[D_FACTOR, c] = factor * d_spring[D_FACTOR, c] + before * d_factor


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
    return [*forms, *list_free_forms(law, "spring_reach", setting.joints)]


EFFECT = Effect(
    "strain_stiffening",
    "the joint gets stiffer as it bends",
    "within_trial",
    _build_forms,
    hooks=(
        Hook(
            "spring",
            stiffen,
            ("stiffening_square", "stiffening_linear", "stiffening_exponential", "spring_law"),
        ),
    ),
    of_motion=True,
)
