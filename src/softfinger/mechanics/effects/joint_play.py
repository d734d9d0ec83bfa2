"""Play of a joint.

A gap about rest, in which the spring has no torque: the damper still slows the link there; free:
any spring beyond it. Taken up: the link is loose in the gap, and lies at its end as soon as the
torque is larger than what keeps it from there.
"""

import math

import numpy as np
from numpy.typing import NDArray

from softfinger.compiled import compiled
from softfinger.mechanics.effects.effect import (
    Effect,
    Form,
    Parameter,
    Setting,
    Values,
    positive,
)
from softfinger.mechanics.effects.law import Law, free_form
from softfinger.mechanics.forward.hooks import Hook
from softfinger.mechanics.forward.ramp import softplus
from softfinger.mechanics.forward.slot import Slot, declare
from softfinger.mechanics.forward.spring import D_FREE, FREE, LEAD, SLOPE, STEEP, VALUE
from softfinger.mechanics.forward.work import Model

WIDTH_RAD = 0.005  # over which the torque sets in


_PLAY, _WIDTH, _TAKEN, _NEEDED = declare(
    play=Slot(
        "joint", "rad", 0.0, "elastic angle, either way, that requires no torque", "nonnegative"
    ),
    play_width=Slot(
        "joint", "rad", 1e-3, "angle over which the torque sets in", "positive", constant=True
    ),
    play_taken=Slot("joint", "rad", 0.0, "link angle tanh(τ/needed), taken up at once"),
    play_needed=Slot("joint", "N m", 1.0, "torque that this needs", "positive"),
)


@compiled
def leave_play(
    model: Model, j: int, time: float, elastic: float, angle: float, spring: NDArray,
    d_spring: NDArray, tangents: bool,
) -> None:  # fmt: skip
    """The elastic angle beyond the play p.

    S(q_v − p) − S(−q_v − p) with a soft ramp S.
    """
    play, width = model.joint[j, _PLAY], model.joint[j, _WIDTH]
    by_play = -math.tanh(elastic / (2.0 * width))
    if play > 0.0:
        above, rise = softplus(elastic - play, width)
        below, fall = softplus(-elastic - play, width)
        spring[FREE], spring[STEEP], by_play = above - below, rise + fall, fall - rise
    spring[LEAD] = play
    if tangents:
        for c in model.columns[j]:
            d_spring[D_FREE, c] += by_play * model.d_joint[c, j, _PLAY]


@compiled
def take_up(model: Model, j: int, torque: float, given: NDArray, row: NDArray) -> None:
    """The link angle p tanh(τ/n), at once."""
    play, needed = model.joint[j, _TAKEN], model.joint[j, _NEEDED]
    taken = math.tanh(torque / needed)
    slope = play * (1.0 - taken * taken) / needed
    given[VALUE] += play * taken
    given[SLOPE] += slope
    if row.size > 0:
        for c in model.columns[j]:
            change = model.d_joint[c, j]
            row[c] += taken * change[_TAKEN] - slope * torque / needed * change[_NEEDED]


def _build_forms(setting: Setting) -> list[Form]:
    play = positive("play_rad", 0.05, per="joint", floor=2e-4)

    def slots(values: Values) -> dict:
        return {"play": values["play_rad"], "play_width": WIDTH_RAD}

    usual, most = np.log(0.1 * setting.torque), np.log(0.5 * setting.torque)
    needed = Parameter("needed_torque_nm", usual, 1.0, log=True, low=usual - 4.0, high=most)

    def take(values: Values) -> dict:
        return {"play_taken": values["play_rad"], "play_needed": values["needed_torque_nm"]}

    gap, taken = Form("gap", (play,), slots), Form("taken_up", (play, needed), take)
    law = Law("spring_law", "elastic_angle_rad", setting.reach, 0.5, terms=5, per="joint")
    return [gap, taken, free_form(law, {"spring_reach": setting.reach}, gap, lent=True)]


EFFECT = Effect(
    "joint_play",
    "the joint has play before its spring takes up the torque",
    "within_trial",
    _build_forms,
    hooks=(Hook("spring", leave_play, ("play",)), Hook("give", take_up, ("play_taken",))),
    of_motion=True,
)
