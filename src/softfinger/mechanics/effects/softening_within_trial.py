"""Stiffness or viscosities fall within a trial.

Heat and water thin both dampers of a joint; its creep alone may thin too.

Under one load in each trial that is a course in time, as creep is. Free: any smooth course beside
an exponential. A course that falls and rises again is something else's: of the direction of motion,
of rest.
"""

import math

import numpy as np
from numpy.typing import NDArray

from softfinger.compiled import compiled
from softfinger.mechanics.effects.creep_spectrum import CREEP
from softfinger.mechanics.effects.effect import (
    FREE,
    Effect,
    Form,
    Setting,
    Values,
    positive,
    time_constant,
)
from softfinger.mechanics.effects.law import Law, free_form
from softfinger.mechanics.forward.curve import Weights, combine, draw_curve, weigh_value
from softfinger.mechanics.forward.hooks import Hook
from softfinger.mechanics.forward.slot import Slot, declare
from softfinger.mechanics.forward.spring import (
    BY_ANGLE,
    BY_ELASTIC,
    D_FACTOR,
    FACTOR,
    SLOPE,
    VALUE,
)
from softfinger.mechanics.forward.work import Model

TARGETS = {
    "stiffness": "softening_elastic",
    "viscosity": "softening_flow",
    "viscosities": "softening_flow",
}


_ELASTIC, _FLOW, _TIME, _DAMPER, _ELASTIC_LAW, _FLOW_LAW, _REACH = declare(
    softening_elastic=Slot(
        "joint", "1", 0.0, "k_v (1 - s (1 - exp(-t/T))), t in the trial", below=1.0
    ),
    softening_flow=Slot("joint", "1", 0.0, "c_p (1 - s (1 - exp(-t/T)))", below=1.0),
    softening_time=Slot("joint", "s", 1.0, "their time T", "positive"),
    softening_damper=Slot(
        "joint", "1", 0.0, "whether c_v falls as c_p does (1) or not (0)", constant=True
    ),
    softening_elastic_law=Slot("law", "1", 0.0, "k_v times exp(law), a law of t"),
    softening_flow_law=Slot("law", "1", 0.0, "c_p times exp(law), a law of t"),
    softening_reach=Slot("joint", "s", 1.0, "t at which these end", "positive", constant=True),
)


@compiled
def soften(time: float, constant: float) -> tuple[float, float]:
    """How far a softening has come: 1 − e^{−t/T}.

    0 before the start; returns it and its derivative by T.
    """
    ratio = max(time, 0.0) / constant
    return -math.expm1(-ratio), -ratio * math.exp(-ratio) / constant


@compiled
def _leave(model: Model, j: int, time: float, slot: int, law: int) -> tuple[float, float, float]:
    """What is left of a stiffness or viscosity.

    (1 − s (1 − e^{−t/T})) e^{law(t)}, and its derivatives by s and T.
    """
    share, (eased, by_time) = model.joint[j, slot], soften(time, model.joint[j, _TIME])
    bent = math.exp(combine(model.law[j, law], _weigh_time(model, j, time)))
    return (1.0 - share * eased) * bent, -eased * bent, -share * by_time * bent


@compiled
def _weigh_time(model: Model, j: int, time: float) -> Weights:
    """The weights of a law of the time in the trial."""
    return weigh_value(max(time, 0.0) / model.joint[j, _REACH])


@compiled
def soften_spring(
    model: Model, j: int, time: float, elastic: float, angle: float, spring: NDArray,
    d_spring: NDArray, tangents: bool,
) -> None:  # fmt: skip
    """The stiffness times what is left of it."""
    left, by_share, by_time = _leave(model, j, time, _ELASTIC, _ELASTIC_LAW)
    before = spring[FACTOR]
    spring[FACTOR] *= left
    spring[BY_ELASTIC] *= left
    spring[BY_ANGLE] *= left
    if tangents:
        weights = _weigh_time(model, j, time)
        for c in model.columns[j]:
            change = model.d_joint[c, j]
            more = by_share * change[_ELASTIC] + by_time * change[_TIME]
            more += left * combine(model.d_law[c, j, _ELASTIC_LAW], weights)
            d_spring[D_FACTOR, c] = left * d_spring[D_FACTOR, c] + before * more


@compiled
def soften_flow(
    model: Model, j: int, time: float, torque: float, drive: NDArray, row: NDArray
) -> None:
    """The flow over what softening leaves of c_p."""
    _thin(model, j, time, drive, row)


@compiled
def soften_damper(
    model: Model, j: int, time: float, force: float, thin: NDArray, row: NDArray
) -> None:
    """The Voigt element's rate over what is left of c_v."""
    if model.joint[j, _DAMPER] > 0.5:
        _thin(model, j, time, thin, row)


@compiled
def _thin(model: Model, j: int, time: float, pair: NDArray, row: NDArray) -> None:
    """Divide a value, its slope and changes by what a viscosity keeps."""
    left, by_share, by_time = _leave(model, j, time, _FLOW, _FLOW_LAW)
    pair[VALUE] /= left
    pair[SLOPE] /= left
    if row.size > 0:
        weights = _weigh_time(model, j, time)
        for c in model.columns[j]:
            change = model.d_joint[c, j]
            more = by_share * change[_FLOW] + by_time * change[_TIME]
            more += left * combine(model.d_law[c, j, _FLOW_LAW], weights)
            row[c] = (row[c] - pair[VALUE] * more) / left


def follow_course(slots: Values, time: NDArray[np.float64]) -> NDArray[np.float64]:
    """Logarithm of what is left (joint, n), at times (n,).

    It is that of the stiffness or of the viscosity, whichever softens.
    """
    eased = -np.expm1(-time / np.atleast_1d(slots["softening_time"])[:, None])
    course = np.zeros_like(eased)
    for name in set(TARGETS.values()) & set(slots):
        course = course + np.log1p(-np.atleast_1d(slots[name])[:, None] * eased)
    for name in (f"{name}_law" for name in set(TARGETS.values())):
        if name in slots:
            course = course + draw_curve(slots[name], time / slots["softening_reach"])
    return course


def _build_form(target: str, setting: Setting) -> Form:
    share = positive("softening_share", 0.2, per="joint", high=0.9, floor=5e-4)
    time = time_constant("softening_time_s", 5 * setting.interval, 3 * setting.duration, starts=3)

    def slots(values: Values) -> dict:
        return {
            TARGETS[target]: values["softening_share"],
            "softening_time": values["softening_time_s"],
            "softening_damper": float(target == "viscosities"),
        }

    return Form(target, (share, time), slots)


def _build_free_form(target: str, setting: Setting) -> Form:
    reach = setting.duration
    law = Law(
        f"{TARGETS[target]}_law", "time_in_trial_s", reach, 0.5, terms=5, per="joint",
        kind="exponential",
    )  # fmt: skip
    constants = {"softening_reach": reach}
    return free_form(law, constants, _build_form(target, setting), name=f"{FREE}_{target}")


def _build_forms(setting: Setting) -> list[Form]:
    return [
        build(target, setting) for build in (_build_form, _build_free_form) for target in TARGETS
    ]


EFFECT = Effect(
    "softening_within_trial",
    "the joint softens while the trial runs",
    "within_trial",
    _build_forms,
    hooks=(
        Hook("spring", soften_spring, ("softening_elastic", "softening_elastic_law")),
        Hook("flow", soften_flow, ("softening_flow", "softening_flow_law")),
        Hook("damper", soften_damper, ("softening_damper",)),
    ),
    of_motion=True,
    place_in_time=CREEP,
    course=follow_course,
)
