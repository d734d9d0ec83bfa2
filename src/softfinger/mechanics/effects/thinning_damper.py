"""A damper that thins.

The torque of the Voigt damper rises less than its rate.

Torque ∝ rate^n where the torque is large, and in proportion where it is small (Ellis); free: the
rate is any smooth function of the damper's torque. Of the rate: it thins from a rate, which is the
same for trials of any viscosity, and not from a torque.

Ellis; in Bird, Armstrong and Hassager (1987), Dynamics of Polymeric Liquids 1, section 4.1.
"""

import math

import numpy as np
from numpy.typing import NDArray

from softfinger.compiled import compiled
from softfinger.mechanics.effects.creep_spectrum import CREEP
from softfinger.mechanics.effects.effect import FREE, Effect, Form, Setting, Values, positive
from softfinger.mechanics.effects.law import Law, list_free_forms
from softfinger.mechanics.forward.curve import combine, weigh_slope, weigh_value
from softfinger.mechanics.forward.hooks import Hook
from softfinger.mechanics.forward.slot import LOG_C_V, Slot, declare
from softfinger.mechanics.forward.spring import SLOPE, VALUE
from softfinger.mechanics.forward.work import Model

BENDS = {"early": 0.05, "late": 0.3}  # of the usual load: torque from which it thins


_POWER, _LAW, _REFERENCE, _BY_RATE = declare(
    damper_power=Slot(
        "joint", "1", 0.0, "Voigt damper: rate ∝ F (1 + (F/reference)²)^(b/2)", "nonnegative"
    ),
    damper_law=Slot("law", "1", 0.0, "Voigt damper: rate ∝ F exp(law), a law of its torque |F|"),
    damper_reference=Slot(
        "joint", "N m or rad/s", 1.0, "of the power; where the law ends", "positive", constant=True
    ),
    damper_by_rate=Slot(
        "joint", "1", 0.0, "it thins by F (0) or by F/c_v, the rate that it had (1)", constant=True
    ),
)  # fmt: skip


@compiled
def thin_damper(
    model: Model, j: int, time: float, force: float, thin: NDArray, row: NDArray
) -> None:
    """The thinning (1 + (F/reference)²)^{b/2} e^{law of |F|}, or of F/c_v."""
    power, law, by_rate = model.joint[j, _POWER], model.law[j, _LAW], model.joint[j, _BY_RATE] > 0.5
    scale = model.joint[j, _REFERENCE] * (math.exp(model.joint[j, LOG_C_V]) if by_rate else 1.0)
    ratio = force / scale
    square, weights = 1.0 + ratio * ratio, weigh_value(abs(ratio))
    climb = combine(law, weigh_slope(abs(ratio))) * math.copysign(1.0, ratio)
    factor = math.exp(0.5 * power * math.log(square) + combine(law, weights))
    lean = power * ratio / square + climb  # of the factor's logarithm, by the ratio
    thin[SLOPE] = factor * thin[SLOPE] + thin[VALUE] * factor * lean / scale
    thin[VALUE] *= factor
    if row.size > 0:
        for c in model.columns[j]:
            d_log = 0.5 * math.log1p(ratio * ratio) * model.d_joint[c, j, _POWER]
            d_log += combine(model.d_law[c, j, _LAW], weights)
            if by_rate:
                d_log -= lean * ratio * model.d_joint[c, j, LOG_C_V]
            row[c] = factor * row[c] + thin[VALUE] * d_log


def _build_form(name: str, setting: Setting, *, by_rate: bool) -> Form:
    power = positive(
        "thinning",
        1.0,
        per="joint",
        floor=2e-3,
        report={"exponent": lambda b, _: 1.0 / (1.0 + max(b, 0.0))},
    )

    def slots(values: Values) -> dict:
        reference = BENDS[name] * _find_usual(setting, by_rate=by_rate)
        known = {"damper_reference": reference, "damper_by_rate": float(by_rate)}
        return {"damper_power": values["thinning"], **known}

    return Form(f"{name}_of_rate" if by_rate else name, (power,), slots)


def _find_usual(setting: Setting, *, by_rate: bool) -> NDArray[np.float64]:
    """The usual load (joint,) [N m], or the rate [rad/s] at which the usual damper takes it."""
    torque = np.full(setting.joints, setting.torque)
    return torque / (setting.own_time * setting.stiffness) if by_rate else torque


def _list_free_forms(setting: Setting, *, by_rate: bool) -> list[Form]:
    law = Law(
        "damper_law",
        "damper_rate_rad_per_s" if by_rate else "damper_torque_nm",
        _find_usual(setting, by_rate=by_rate),
        1.0,
        terms=5,
        per="joint",
        kind="exponential",
    )
    name, known = f"{FREE}_of_rate" if by_rate else FREE, {"damper_by_rate": float(by_rate)}
    return list_free_forms(law, "damper_reference", setting.joints, known, name)


def _build_forms(setting: Setting) -> list[Form]:
    ways = False, True
    forms = [_build_form(name, setting, by_rate=way) for way in ways for name in BENDS]
    return forms + [form for way in ways for form in _list_free_forms(setting, by_rate=way)]


EFFECT = Effect(
    "thinning_damper",
    "the damper thins as its rate grows",
    "within_trial",
    _build_forms,
    hooks=(Hook("damper", thin_damper, ("damper_power", "damper_law")),),
    of_motion=True,
    place_in_time=CREEP,
)
