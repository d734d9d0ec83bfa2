"""Play of a joint.

A gap about rest, in which the spring has no torque: the damper still slows the link there; free:
any spring beyond it. With soft edges the torque sets in little by little. Taken up: the
link is loose in the gap, and lies at its end as soon as the torque is larger than what keeps it
from there, or little by little, or about one torque (Hill). Backlash: the link follows what turns
it at one end of the gap, and after a turn at the other; with soft edges a part of it does so by a
narrower gap (two operators of Prandtl and Ishlinskii).
"""

import math
from dataclasses import replace

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
from softfinger.mechanics.forward.slot import Q_INI, Slot, declare
from softfinger.mechanics.forward.spring import D_FREE, FREE, LEAD, SLOPE, STEEP, VALUE
from softfinger.mechanics.forward.work import Model

WIDTH_RAD = 0.005  # over which the torque sets in
LEFT = 1e-3  # share of the stiffness within soft edges: a joint without load rests at one angle


_PLAY, _WIDTH, _HARD, _TAKEN, _NEEDED, _STEEP, _BACKLASH, _SHARE, _RATIO = declare(
    play=Slot(
        "joint", "rad", 0.0, "elastic angle, either way, that requires no torque", "nonnegative"
    ),
    play_width=Slot(
        "joint", "rad", 1e-3, "angle over which the torque sets in", "positive", constant=True
    ),
    play_hardness=Slot("joint", "1", 0.0, "n > 0: of soft edges in place of that", "nonnegative"),
    play_taken=Slot("joint", "rad", 0.0, "link angle tanh(τ/needed), taken up at once"),
    play_needed=Slot("joint", "N m", 1.0, "torque that this needs", "positive"),
    play_steepness=Slot(
        "joint", "1", 0.0, "n > 0: of |τ|ⁿ/(neededⁿ + |τ|ⁿ) in place of tanh", "nonnegative"
    ),
    play_backlash=Slot("joint", "rad", 0.0, "angle lost at each turn of the motion", "nonnegative"),
    play_narrow_share=Slot("joint", "1", 0.0, "part that follows by a narrower gap", "nonnegative"),
    play_narrow_ratio=Slot("joint", "1", 0.5, "width of that gap over the other's", "positive"),
)


@compiled
def leave_play(
    model: Model, j: int, time: float, elastic: float, angle: float, spring: NDArray,
    d_spring: NDArray, tangents: bool,
) -> None:  # fmt: skip
    """The elastic angle beyond the play p.

    S(q_v − p) − S(−q_v − p) with a soft ramp S; with soft edges `leave_softly`.
    """
    play, width, hard = model.joint[j, _PLAY], model.joint[j, _WIDTH], model.joint[j, _HARD]
    by_play, by_hard = -math.tanh(elastic / (2.0 * width)), 0.0
    if play > 0.0 and hard > 0.0:
        spring[FREE], spring[STEEP], by_play, by_hard = leave_softly(elastic, play, hard)
    elif play > 0.0:
        above, rise = softplus(elastic - play, width)
        below, fall = softplus(-elastic - play, width)
        spring[FREE], spring[STEEP], by_play = above - below, rise + fall, fall - rise
    spring[LEAD] = play
    if tangents:
        for c in model.columns[j]:
            change = model.d_joint[c, j]
            d_spring[D_FREE, c] += by_play * change[_PLAY] + by_hard * change[_HARD]


@compiled
def leave_softly(elastic: float, play: float, hard: float) -> tuple[float, float, float, float]:
    """The elastic angle beyond play with soft edges.

    q_v − (p/2n) log(cosh(u + n)/cosh(u − n)), with u = n q_v/(p tanh n): stiffness begins at
    `LEFT` of the spring's, and far from rest the play is p. For n → 0 it is q_v − p tanh(q_v/p),
    for n → ∞ a gap. Returns it, and its derivatives by q_v, p and n.
    """
    tanh = math.tanh(hard)
    at = hard * elastic / (play * tanh)
    rise, fall = math.tanh(at + hard), math.tanh(at - hard)
    far, near = abs(at + hard), abs(at - hard)
    length = far - near + math.log1p(math.exp(-2.0 * far)) - math.log1p(math.exp(-2.0 * near))
    turn = at * (1.0 / hard - (1.0 - tanh * tanh) / tanh)
    half = 0.5 * (1.0 - LEFT) / hard
    by_hard = play * half * (length / hard - rise * (turn + 1.0) + fall * (turn - 1.0))
    steep = 1.0 - 0.5 * (1.0 - LEFT) * (rise - fall) / tanh
    return elastic - play * half * length, steep, half * (at * (rise - fall) - length), by_hard


@compiled
def take_up(model: Model, j: int, torque: float, given: NDArray, row: NDArray) -> None:
    """The link angle that play adds at once.

    p tanh(τ/needed), or p sgn(τ) |τ/needed|ⁿ/(1 + |τ/needed|ⁿ).
    """
    play, needed, n = model.joint[j, _TAKEN], model.joint[j, _NEEDED], model.joint[j, _STEEP]
    x, sign, by_n = abs(torque) / needed, math.copysign(1.0, torque), 0.0
    if n > 0.0:
        power = x**n
        taken = power / (1.0 + power)
        rise = n * x ** (n - 1.0) / (1.0 + power) ** 2
        by_n = taken / (1.0 + power) * math.log(x) if x > 0.0 else 0.0
    else:
        taken = math.tanh(x)
        rise = 1.0 - taken * taken
    given[VALUE] += play * sign * taken
    given[SLOPE] += play * rise / needed
    if row.size > 0:
        for c in model.columns[j]:
            change = model.d_joint[c, j]
            by_needed = play * (by_n * change[_STEEP] - rise * x / needed * change[_NEEDED])
            row[c] += sign * (taken * change[_TAKEN] + by_needed)


@compiled
def follow_late(
    model: Model, angle: NDArray, by: NDArray, seen: NDArray, gradient: NDArray
) -> None:
    """The angle of a link that follows after play.

    The gap's middle moves only while the joint lies at an end of the gap; it begins at q_ini. A
    part of the angle may follow by a narrower gap.
    """
    joints, _, columns = gradient.shape
    d_half, d_part = np.empty(columns), np.empty(columns)
    for j in range(joints):
        half, share = 0.5 * model.joint[j, _BACKLASH], model.joint[j, _SHARE]
        ratio = model.joint[j, _RATIO]
        for c in range(columns):
            d_half[c] = 0.5 * model.d_joint[c, j, _BACKLASH]
            d_part[c] = -model.d_joint[c, j, _SHARE]
        _follow(model, j, half, d_half, 1.0 - share, d_part, angle, by, seen, gradient)
        if share > 0.0:
            for c in range(columns):
                d_half[c] = ratio * d_half[c] + half * model.d_joint[c, j, _RATIO]
                d_part[c] = -d_part[c]
            _follow(model, j, ratio * half, d_half, share, d_part, angle, by, seen, gradient)


@compiled
def _follow(
    model: Model, j: int, half: float, d_half: NDArray, part: float, d_part: NDArray,
    angle: NDArray, by: NDArray, seen: NDArray, gradient: NDArray,
) -> None:  # fmt: skip
    """Add what one gap takes from a part of the angle."""
    middle, columns = model.joint[j, Q_INI], d_half.size
    held = np.empty(columns)
    for c in range(columns):
        held[c] = model.d_joint[c, j, Q_INI]
    for frame in range(angle.shape[1]):
        now = angle[j, frame]
        if abs(now - middle) > half:
            side = math.copysign(1.0, now - middle)
            middle = now - side * half
            for c in range(columns):
                held[c] = by[j, frame, c] - side * d_half[c]
        seen[j, frame] += part * (middle - now)
        for c in range(columns):
            lag = part * (held[c] - by[j, frame, c])
            gradient[j, frame, c] += lag + d_part[c] * (middle - now)


def _build_forms(setting: Setting) -> list[Form]:
    play = positive("play_rad", 0.05, per="joint", floor=2e-4)

    def slots(values: Values) -> dict:
        return {"play": values["play_rad"], "play_width": WIDTH_RAD}

    edge = Parameter("softness", 0.5, 0.25, low=0.05, high=0.95)

    def open_softly(values: Values) -> dict:
        return slots(values) | {"play_hardness": 1.0 / values["softness"] - 1.0}

    usual, most = np.log(0.1 * setting.torque), np.log(0.5 * setting.torque)
    needed = Parameter("needed_torque_nm", usual, 1.0, log=True, low=usual - 4.0, high=most)

    def take(values: Values) -> dict:
        return {"play_taken": values["play_rad"], "play_needed": values["needed_torque_nm"]}

    wide = replace(needed, high=np.log(setting.torque))
    steep = Parameter("steepness", np.log(2.0), 0.7, log=True, low=0.0, high=np.log(12.0))

    def rise(values: Values) -> dict:
        return {**take(values), "play_steepness": values["steepness"]}

    gap = Form("gap", (play,), slots, finer=Form("gap_with_soft_edges", (play, edge), open_softly))
    law = Law("spring_law", "elastic_angle_rad", setting.reach, 0.5, terms=5, per="joint")
    return [
        gap,
        Form("taken_up", (play, needed), take),
        _build_backlash(play),
        free_form(law, {"spring_reach": setting.reach}, gap, lent=True),
        Form("taken_up_steeply", (play, wide, steep), rise),
    ]


def _build_backlash(play: Parameter) -> Form:
    def lag(values: Values) -> dict:
        return {"play_backlash": values["play_rad"]}

    part = Parameter("narrow_share", 0.5, 0.25, low=0.02, high=0.98)
    ratio = Parameter("narrow_ratio", 0.5, 0.25, low=0.02, high=0.98)

    def lag_softly(values: Values) -> dict:
        narrow = {f"play_{name}": values[name] for name in ("narrow_share", "narrow_ratio")}
        return lag(values) | narrow

    soft = Form("backlash_with_soft_edges", (play, part, ratio), lag_softly)
    # where its damper took its part, a joint has no use for little of it
    late = replace(play, far=(0.05,))
    return Form("backlash", (late,), lag, finer=soft)


EFFECT = Effect(
    "joint_play",
    "the joint has play before its spring takes up the torque",
    "within_trial",
    _build_forms,
    hooks=(
        Hook("spring", leave_play, ("play",)),
        Hook("give", take_up, ("play_taken",)),
        Hook("observe", follow_late, ("play_backlash",)),
    ),
    of_motion=True,
)
