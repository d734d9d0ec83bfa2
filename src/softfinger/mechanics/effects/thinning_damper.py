"""A damper that thins.

The torque of the Voigt damper rises less than its rate.

Torque ∝ rate^n where the torque is large, and in proportion where it is small (Ellis); free: the
rate is any smooth function of the damper's torque.

Ellis; in Bird, Armstrong and Hassager (1987), Dynamics of Polymeric Liquids 1, section 4.1.
"""

import math

from numpy.typing import NDArray

from softfinger.compiled import compiled
from softfinger.mechanics.effects.creep_spectrum import CREEP
from softfinger.mechanics.effects.effect import Effect, Form, Setting, Values, positive
from softfinger.mechanics.effects.law import Law, list_free_forms
from softfinger.mechanics.forward.curve import combine, weigh_slope, weigh_value
from softfinger.mechanics.forward.hooks import Hook
from softfinger.mechanics.forward.slot import Slot, declare
from softfinger.mechanics.forward.spring import SLOPE, VALUE
from softfinger.mechanics.forward.work import Model

BENDS = {"early": 0.05, "late": 0.3}  # of the usual load: torque from which it thins


_POWER, _LAW, _REFERENCE = declare(
    damper_power=Slot(
        "joint", "1", 0.0, "Voigt damper: rate ∝ F (1 + (F/reference)²)^(b/2)", "nonnegative"
    ),
    damper_law=Slot("law", "1", 0.0, "Voigt damper: rate ∝ F exp(law), a law of its torque |F|"),
    damper_reference=Slot(
        "joint", "N m", 1.0, "reference torque of the power; where the law ends", "positive",
        constant=True,
    ),
)  # fmt: skip


@compiled
def thin_damper(
    model: Model, j: int, time: float, force: float, thin: NDArray, row: NDArray
) -> None:
    """The thinning (1 + (F/reference)²)^{b/2} e^{law of |F|}."""
    power, law = model.joint[j, _POWER], model.law[j, _LAW]
    ratio = force / model.joint[j, _REFERENCE]
    square, weights = 1.0 + ratio * ratio, weigh_value(abs(ratio))
    climb = combine(law, weigh_slope(abs(ratio))) * math.copysign(1.0, ratio)
    factor = math.exp(0.5 * power * math.log(square) + combine(law, weights))
    slope = factor * (power * ratio / square + climb) / model.joint[j, _REFERENCE]
    thin[SLOPE] = factor * thin[SLOPE] + thin[VALUE] * slope
    thin[VALUE] *= factor
    if row.size > 0:
        for c in model.columns[j]:
            d_log = 0.5 * math.log1p(ratio * ratio) * model.d_joint[c, j, _POWER]
            d_log += combine(model.d_law[c, j, _LAW], weights)
            row[c] = factor * row[c] + thin[VALUE] * d_log


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
    forms = [_build_form(name, setting) for name in BENDS]
    law = Law(
        "damper_law",
        "damper_torque_nm",
        setting.torque,
        1.0,
        terms=5,
        per="joint",
        kind="exponential",
    )
    return [*forms, *list_free_forms(law, "damper_reference", setting.joints)]


EFFECT = Effect(
    "thinning_damper",
    "the damper thins as its rate grows",
    "within_trial",
    _build_forms,
    hooks=(Hook("damper", thin_damper, ("damper_power", "damper_law")),),
    of_motion=True,
    place_in_time=CREEP,
)
