"""Play: a gap without torque about rest; free: any spring beyond it."""

import math

from numpy.typing import NDArray

from softfinger.compiled import compiled
from softfinger.mechanics.effects.effect import Effect, Form, Setting, Values, positive
from softfinger.mechanics.effects.law import Law, free_form
from softfinger.mechanics.forward.hooks import Hook
from softfinger.mechanics.forward.ramp import softplus
from softfinger.mechanics.forward.slot import Slot, declare
from softfinger.mechanics.forward.spring import D_FREE, FREE, LEAD, STEEP
from softfinger.mechanics.forward.work import Model

WIDTH_RAD = 0.005  # over which the torque sets in


_PLAY, _WIDTH = declare(
    play=Slot(
        "joint", "rad", 0.0, "elastic angle, either way, that requires no torque", "nonnegative"
    ),
    play_width=Slot(
        "joint", "rad", 1e-3, "angle over which the torque sets in", "positive", constant=True
    ),
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


def _build_forms(setting: Setting) -> list[Form]:
    play = positive("play_rad", 0.05, per="joint", floor=2e-4)

    def slots(values: Values) -> dict:
        return {"play": values["play_rad"], "play_width": WIDTH_RAD}

    gap = Form("gap", (play,), slots)
    law = Law("spring_law", "elastic_angle_rad", setting.reach, 0.5, terms=5, per="joint")
    return [gap, free_form(law, {"spring_reach": setting.reach}, gap, lent=True)]


EFFECT = Effect(
    "joint_play",
    "the joint has play before its spring takes up the torque",
    "within_trial",
    _build_forms,
    hooks=(Hook("spring", leave_play, ("play",)),),
    of_motion=True,
)
