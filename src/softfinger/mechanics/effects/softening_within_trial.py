"""Stiffness or viscosity falls within a trial.

Under one load in each trial that is a course in time, as creep is.
"""

import math

from numpy.typing import NDArray

from softfinger.compiled import compiled
from softfinger.mechanics.effects.creep_spectrum import CREEP
from softfinger.mechanics.effects.effect import (
    Effect,
    Form,
    Setting,
    Values,
    positive,
    time_constant,
)
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

TARGETS = {"stiffness": "softening_elastic", "viscosity": "softening_flow"}


_ELASTIC, _FLOW, _TIME = declare(
    softening_elastic=Slot(
        "joint", "1", 0.0, "k_v (1 - s (1 - exp(-t/T))), t in the trial", below=1.0
    ),
    softening_flow=Slot("joint", "1", 0.0, "c_p (1 - s (1 - exp(-t/T)))", below=1.0),
    softening_time=Slot("joint", "s", 1.0, "their time T", "positive"),
)


@compiled
def soften(time: float, constant: float) -> tuple[float, float]:
    """How far a softening has come: 1 − e^{−t/T}.

    0 before the start; returns it and its derivative by T.
    """
    ratio = max(time, 0.0) / constant
    return -math.expm1(-ratio), -ratio * math.exp(-ratio) / constant


@compiled
def soften_spring(
    model: Model, j: int, time: float, elastic: float, angle: float, spring: NDArray,
    d_spring: NDArray, tangents: bool,
) -> None:  # fmt: skip
    """The stiffness times 1 − s (1 − e^{−t/T})."""
    share, (eased, by_time) = model.joint[j, _ELASTIC], soften(time, model.joint[j, _TIME])
    left, before = 1.0 - share * eased, spring[FACTOR]
    spring[FACTOR] *= left
    spring[BY_ELASTIC] *= left
    spring[BY_ANGLE] *= left
    if tangents:
        for c in model.columns[j]:
            change = model.d_joint[c, j]
            d_left = -change[_ELASTIC] * eased - share * by_time * change[_TIME]
            d_spring[D_FACTOR, c] = left * d_spring[D_FACTOR, c] + before * d_left


@compiled
def soften_flow(
    model: Model, j: int, time: float, torque: float, drive: NDArray, row: NDArray
) -> None:
    """The flow over what softening leaves of the viscosity."""
    share, (eased, by_time) = model.joint[j, _FLOW], soften(time, model.joint[j, _TIME])
    left = 1.0 - share * eased
    drive[VALUE] /= left
    drive[SLOPE] /= left
    if row.size > 0:
        for c in model.columns[j]:
            change = model.d_joint[c, j]
            d_left = -change[_FLOW] * eased - share * by_time * change[_TIME]
            row[c] = (row[c] - drive[VALUE] * d_left) / left


def _build_form(target: str, setting: Setting) -> Form:
    share = positive("softening_share", 0.2, per="joint", high=0.9, floor=5e-4)
    time = time_constant("softening_time_s", 5 * setting.interval, 3 * setting.duration, starts=3)

    def slots(values: Values) -> dict:
        return {
            TARGETS[target]: values["softening_share"],
            "softening_time": values["softening_time_s"],
        }

    return Form(target, (share, time), slots)


def _build_forms(setting: Setting) -> list[Form]:
    return [_build_form(target, setting) for target in TARGETS]


EFFECT = Effect(
    "softening_within_trial",
    "the joint softens while the trial runs",
    "within_trial",
    _build_forms,
    hooks=(
        Hook("spring", soften_spring, ("softening_elastic",)),
        Hook("flow", soften_flow, ("softening_flow",)),
    ),
    of_motion=True,
    place_in_time=CREEP,
)
