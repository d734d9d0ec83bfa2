"""The load acts late: by stages, or a free response."""

import math

import numpy as np

from softfinger.compiled import compiled
from softfinger.mechanics.effects.creep_spectrum import CREEP
from softfinger.mechanics.effects.effect import Effect, Form, Parameter, Setting, Values, positive
from softfinger.mechanics.effects.load_response import RESPONSE, build_response
from softfinger.mechanics.forward.advance import delay_jump
from softfinger.mechanics.forward.hooks import Hook
from softfinger.mechanics.forward.slot import Slot, declare
from softfinger.mechanics.forward.work import Load, Model, Nodes, Work

_LAG, _SECOND = declare(
    lag=Slot(
        "chain", "s", 0.0, "mean time by which the acting load follows the log", "nonnegative"
    ),
    lag_second_share=Slot(
        "chain", "1", 0.0, "part of it in a second stage after the first", "nonnegative", below=0.5
    ),
)
_VALUE, _SLOPE = range(2)
_WHOLE, _FIRST = range(2)  # what acts, and what is behind the first stage of two


@compiled
def follow_log(model: Model, load: Load, nodes: Nodes, i: int, since: float, end: bool) -> None:
    """The load behind one stage or two.

    One stage of lag l makes v + s (t − l) + (u₀ − v + l s) e^{−t/l} of a log v + s t. One of no lag
    is the log itself, which moves with a lag as −s.
    """
    lag, slope = model.chain[_LAG], load.log[_SLOPE]
    if lag > 0.0 and model.chain[_SECOND] > 0.0:
        _follow_two_stages(model, load, nodes, i, since)
    elif lag > 0.0:
        decay = math.exp(-since / lag)
        gap = load.acting[_WHOLE] - load.log[_VALUE] + lag * slope
        nodes.load[i] = load.log[_VALUE] + slope * (since - lag) + gap * decay
        by_lag = slope * (decay - 1.0) + gap * decay * since / (lag * lag)
        for c in range(load.d_log.shape[1]):
            value, climb = load.d_log[_VALUE, c], load.d_log[_SLOPE, c]
            d_gap = load.d_acting[_WHOLE, c] + lag * climb - value
            follows = value + climb * (since - lag) + decay * d_gap
            nodes.d_load[i, c] = by_lag * model.d_chain[c, _LAG] + follows
    else:
        for c in range(load.d_log.shape[1]):
            nodes.d_load[i, c] -= slope * model.d_chain[c, _LAG]
    if end and lag > 0.0:
        if model.chain[_SECOND] > 0.0:
            _advance_first_stage(model, load, since)
        load.acting[_WHOLE] = nodes.load[i]
        load.d_acting[_WHOLE] = nodes.d_load[i]


@compiled
def _follow_two_stages(model: Model, load: Load, nodes: Nodes, i: int, since: float) -> None:
    """The load behind two lags, l₁ > l₂.

    v + s (t − l₁ − l₂) + A exp(−t/l₁) + B exp(−t/l₂), where A is what the first stage lacks at the
    start times l₁/(l₁ − l₂), and B what then remains to the load that acts.
    """
    slope, lag, share = load.log[_SLOPE], model.chain[_LAG], model.chain[_SECOND]
    first, second = lag * (1.0 - share), lag * share
    apart = first - second
    lack = load.acting[_FIRST] - load.log[_VALUE] + slope * first
    slow = lack * first / apart
    fast = load.acting[_WHOLE] - load.log[_VALUE] + slope * lag - slow
    decay, fading = math.exp(-since / first), math.exp(-since / second)
    nodes.load[i] = load.log[_VALUE] + slope * (since - lag) + slow * decay + fast * fading
    for c in range(load.d_log.shape[1]):
        d_lag = model.d_chain[c, _LAG]
        d_second = d_lag * share + lag * model.d_chain[c, _SECOND]
        d_first = d_lag - d_second
        value, climb = load.d_log[_VALUE, c], load.d_log[_SLOPE, c]
        d_lack = load.d_acting[_FIRST, c] - value + climb * first + slope * d_first
        d_slow = d_lack * first + lack * (first * d_second - second * d_first) / apart
        d_slow /= apart
        d_fast = load.d_acting[_WHOLE, c] - value + climb * lag + slope * d_lag - d_slow
        nodes.d_load[i, c] = (
            (d_slow + slow * since * d_first / (first * first)) * decay
            + (d_fast + fast * since * d_second / (second * second)) * fading
            - slope * d_lag
            + value
            + climb * (since - lag)
        )


@compiled
def _advance_first_stage(model: Model, load: Load, since: float) -> None:
    """Follow the first stage to a segment's end."""
    slope, lag, share = load.log[_SLOPE], model.chain[_LAG], model.chain[_SECOND]
    first = lag * (1.0 - share)
    decay = math.exp(-since / first)
    lack = load.acting[_FIRST] - load.log[_VALUE] + slope * first
    load.acting[_FIRST] = load.log[_VALUE] + slope * (since - first) + lack * decay
    by_first = slope * (decay - 1.0) + lack * decay * since / (first * first)
    for c in range(load.d_log.shape[1]):
        d_first = model.d_chain[c, _LAG] * (1.0 - share) - lag * model.d_chain[c, _SECOND]
        value, climb = load.d_log[_VALUE, c], load.d_log[_SLOPE, c]
        d_lack = load.d_acting[_FIRST, c] - value + climb * first
        moved = by_first * d_first + decay * d_lack
        load.d_acting[_FIRST, c] = moved + value + climb * (since - first)


@compiled
def set_pace(model: Model, work: Work, j: int) -> None:
    """The time in which what acts moves."""
    if model.chain[_LAG] > 0.0:
        work.load.pace[0] = model.chain[_LAG]


@compiled
def smooth_jump(model: Model, work: Work, jump: float) -> None:
    """Kick the tangents where the load jumps.

    A lag of nothing delays a jump by d(lag).
    """
    delay_jump(work, jump, model.d_chain[:, _LAG])


def _build_forms(setting: Setting) -> list[Form] | str:
    if not setting.load_known:
        return "there is no load log to lag behind"
    # a lag and the joint's own relaxation are filters in series: either may be the slow one
    slow = 2.0 * float(np.max(setting.own_time))
    lag = positive("lag_s", 5 * setting.interval, floor=setting.time_floor, far=(slow,))
    share = Parameter("second_stage_share", 0.25, 0.12, low=0.02, high=0.48, starts=(0.25,))

    def slots(values: Values) -> dict:
        return {"lag": values["lag_s"]}

    def slots_of_two(values: Values) -> dict:
        return {"lag": values["lag_s"], "lag_second_share": values["second_stage_share"]}

    two = Form("two_stages", (lag, share), slots_of_two)
    if setting.joints == 1:  # it creeps by a free response as well
        return [Form("first_order", (lag,), slots), two]
    free = build_response(setting)
    if setting.levels:
        return [Form("first_order", (lag,), slots), two, free]
    # under one load any joint creeps by such a response: alone it is no sign of a lag
    return [Form("first_order", (lag,), slots, finer=free), two]


EFFECT = Effect(
    "actuator_lag",
    "the load that acts lags the logged one",
    "within_trial",
    _build_forms,
    place_of_one=CREEP,
    hooks=(
        Hook("follow", follow_log, ("lag",)),
        Hook("rest", set_pace, ("lag",)),
        Hook("jump", smooth_jump, ("lag",)),
        RESPONSE,
    ),
)
