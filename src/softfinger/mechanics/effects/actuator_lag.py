"""The load acts late: by stages, ringing, or a free response."""

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

SERIES = 1e-2  # (bt)² below which four terms of a series have more digits
_LAG, _PRODUCT = declare(
    lag=Slot(
        "chain", "s", 0.0, "mean time by which the acting load follows the log", "nonnegative"
    ),
    lag_product=Slot(
        "chain",
        "1",
        0.0,
        "product of two stages' times per square of their sum; above 1/4 the load rings",
        "nonnegative",
    ),
)
_VALUE, _SLOPE = range(2)
_WHOLE, _AHEAD = range(2)  # what acts, and where that would be a lag later at its speed


@compiled
def follow_log(model: Model, load: Load, nodes: Nodes, i: int, since: float, end: bool) -> None:
    """The load behind one stage or a second order.

    One stage of lag l makes v + s (t − l) + (u₀ − v + l s) e^{−t/l} of a log v + s t. One of no lag
    is the log itself, which moves with a lag as −s.
    """
    lag, slope = model.chain[_LAG], load.log[_SLOPE]
    if lag > 0.0 and model.chain[_PRODUCT] > 0.0:
        _follow_second_order(model, load, nodes, i, since, end)
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
        load.acting[_WHOLE] = nodes.load[i]
        load.d_acting[_WHOLE] = nodes.d_load[i]


@compiled
def _follow_second_order(
    model: Model, load: Load, nodes: Nodes, i: int, since: float, end: bool
) -> None:
    """The load u behind two stages, or behind a drive that rings.

    p l² ü + l u̇ + u = v + s t, and so u = v + s (t − l) + h with h = e^{−at} (h₀ cosh bt + (ḣ₀ +
    a h₀) sinh bt / b), a = 1/(2 p l), ω² = 1/(p l²), b² = a² − ω². What is remembered beside u is
    u + l u̇, which at rest is u.
    """
    value, slope, lag = load.log[_VALUE], load.log[_SLOPE], model.chain[_LAG]
    product, old, ahead = model.chain[_PRODUCT], load.acting[_WHOLE], load.acting[_AHEAD]
    rate, square = 0.5 / (product * lag), 1.0 / (product * lag * lag)
    grown, swung, bent = _swing(rate, square, since)
    lack, pull = old - value + slope * lag, (ahead - old) / lag - slope
    away, back = pull + rate * lack, square * lack + rate * pull
    nodes.load[i] = value + slope * (since - lag) + lack * grown + away * swung
    speed = slope + pull * grown - back * swung
    for c in range(load.d_log.shape[1]):
        d_lag, d_product = model.d_chain[c, _LAG] / lag, model.d_chain[c, _PRODUCT] / product
        d_rate, d_square = -rate * (d_product + d_lag), -square * (d_product + 2.0 * d_lag)
        d_gap = 2.0 * rate * d_rate - d_square
        d_grown = 0.5 * since * swung * d_gap - since * d_rate * grown
        d_swung = bent * d_gap - since * d_rate * swung
        climb, d_old = load.d_log[_SLOPE, c], load.d_acting[_WHOLE, c]
        d_lack = d_old - load.d_log[_VALUE, c] + lag * (climb + slope * d_lag)
        d_pull = (load.d_acting[_AHEAD, c] - d_old) / lag - (pull + slope) * d_lag - climb
        d_away = d_pull + d_rate * lack + rate * d_lack
        d_back = d_square * lack + square * d_lack + d_rate * pull + rate * d_pull
        d_load = load.d_log[_VALUE, c] + climb * (since - lag) - slope * lag * d_lag
        d_load += d_lack * grown + lack * d_grown + d_away * swung + away * d_swung
        nodes.d_load[i, c] = d_load
        if end:
            d_speed = climb + d_pull * grown + pull * d_grown - d_back * swung - back * d_swung
            load.d_acting[_AHEAD, c] = d_load + lag * (d_lag * speed + d_speed)
    if end:
        load.acting[_AHEAD] = nodes.load[i] + lag * speed


@compiled
def _swing(rate: float, square: float, since: float) -> tuple[float, float, float]:
    """Decayed cosh bt, sinh bt / b, and half of (t cosh bt − sinh bt / b) / b².

    b² is rate² − square; below 0 they are a cosine and a sine.
    """
    gap = rate * rate - square
    x = gap * since * since
    if abs(x) < SERIES:  # all are smooth where b is 0
        decay = math.exp(-rate * since)
        grown = 1.0 + x / 2.0 * (1.0 + x / 12.0 * (1.0 + x / 30.0))
        swung = since * (1.0 + x / 6.0 * (1.0 + x / 20.0 * (1.0 + x / 42.0)))
        bent = since**3 / 6.0 * (1.0 + x / 10.0 * (1.0 + x / 28.0 * (1.0 + x / 54.0)))
        return decay * grown, decay * swung, decay * bent
    turn = math.sqrt(abs(gap))
    if gap > 0.0:
        slow, fast = math.exp(-square / (rate + turn) * since), math.exp(-(rate + turn) * since)
        grown, swung = 0.5 * (slow + fast), 0.5 * (slow - fast) / turn
    else:
        decay = math.exp(-rate * since)
        grown = decay * math.cos(turn * since)
        swung = decay * math.sin(turn * since) / turn
    return grown, swung, 0.5 * (since * grown - swung) / gap


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
    damping = Parameter("damping_ratio", 0.5, 0.25, low=0.05, high=1.0, starts=(0.3, 0.6))

    def slots(values: Values) -> dict:
        return {"lag": values["lag_s"]}

    def slots_of_two(values: Values) -> dict:
        share = values["second_stage_share"]
        return {"lag": values["lag_s"], "lag_product": share * (1.0 - share)}

    def slots_of_ringing(values: Values) -> dict:
        return {"lag": values["lag_s"], "lag_product": 0.25 / values["damping_ratio"] ** 2}

    two = Form("two_stages", (lag, share), slots_of_two)
    ringing = Form("ringing", (lag, damping), slots_of_ringing)
    if setting.joints == 1:  # it creeps by a free response as well, and rings by its own mass
        return [Form("first_order", (lag,), slots), two]
    free = build_response(setting)
    if setting.levels:
        return [Form("first_order", (lag,), slots), two, ringing, free]
    # under one load any joint creeps by such a response: alone it is no sign of a lag
    return [Form("first_order", (lag,), slots, finer=free), two, ringing]


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
