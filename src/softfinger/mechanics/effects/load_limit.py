"""The load that is logged is not reached.

It saturates, or rises no faster than at some rate.

Limit and rate are shares of the largest load. Free: what acts is any smooth function of the load.
Or it fades: less and less is reached the longer, and the harder, the drive pulls.
"""

import math

import numpy as np
from numpy.typing import NDArray

from softfinger.compiled import compiled
from softfinger.mechanics.effects.effect import Effect, Form, Setting, Values, positive
from softfinger.mechanics.effects.law import Law, free_form
from softfinger.mechanics.effects.load_fade import fade_log, is_fading
from softfinger.mechanics.forward.advance import delay_jump
from softfinger.mechanics.forward.curve import combine, weigh_slope, weigh_value
from softfinger.mechanics.forward.hooks import Hook
from softfinger.mechanics.forward.slot import Slot, declare
from softfinger.mechanics.forward.work import Model, Work

POWER = 8.0  # of the saturation
SELDOM = 1.5  # frames between two rows, beyond which they are read as a line
_SATURATION, _LAW, _REFERENCE, _SLOWNESS = declare(
    load_saturation=Slot(
        "chain", "1", 0.0, "acting load u (1 + b (|u|/reference)^8)^(-1/8); limit b^(-1/8)",
        "nonnegative",
    ),
    load_law=Slot("law", "1", 0.0, "acting load u (1 + law), a law of |u|: that of joint 1"),
    load_reference=Slot(
        "chain", "N m", 1.0, "reference of the saturation; where the law ends", "positive",
        constant=True,
    ),
    load_slowness=Slot(
        "chain", "s/(N m)", 0.0, "1 / the largest rate of the acting load", "nonnegative"
    ),
)  # fmt: skip


@compiled
def saturate(model: Model, load: NDArray, row: NDArray) -> None:
    """What acts of the load.

    u (1 + b (|u|/r)^8)^{−1/8} (1 + law of |u|).
    """
    x, law = abs(load[0]) / model.chain[_REFERENCE], model.law[0, _LAW]
    steep, weights = x**POWER, weigh_value(x)
    bent = 1.0 + model.chain[_SATURATION] * steep
    kept, factor = bent ** (-1.0 / POWER), 1.0 + combine(law, weights)
    slope = kept * (factor / bent + x * combine(law, weigh_slope(x)))
    by_law = load[0] * kept
    load[0] = by_law * factor
    by_saturation = -load[0] * steep / (POWER * bent)
    for c in range(row.size):
        change = by_saturation * model.d_chain[c, _SATURATION]
        change += by_law * combine(model.d_law[c, 0, _LAW], weights)
        row[c] = slope * row[c] + change


@compiled
def reach_log(model: Model, time: NDArray, load: NDArray) -> tuple[NDArray, NDArray, NDArray]:
    """The log that is reached, with its changes."""
    time, load, slower = _slow_down(time, load, model.chain[_SLOWNESS])
    changes = np.zeros((time.size, model.d_chain.shape[0]))
    for knot in range(time.size):
        changes[knot] = slower[knot] * model.d_chain[:, _SLOWNESS]
    return fade_log(model, time, load, changes) if is_fading(model) else (time, load, changes)


@compiled
def slow_jump(model: Model, work: Work, jump: float) -> None:
    """A kick: no slowness delays a jump by nothing.

    That moves by half of what the whole jump takes.
    """
    if model.chain[_SLOWNESS] == 0.0:
        delay_jump(work, jump, 0.5 * abs(jump) * model.d_chain[:, _SLOWNESS])


@compiled
def _slow_down(time: NDArray, load: NDArray, slowness: float) -> tuple[NDArray, NDArray, NDArray]:
    """Follow a log from 0 no faster than 1/slowness.

    At any rate where that is 0. Returns knots (knot,) of time, load and its derivative by the
    slowness. A jump of either is two knots at one time.
    """
    last = time.size - 1
    if not slowness > 0.0:
        return time.copy(), load.copy(), np.zeros(time.size)
    knots, count, rate = np.zeros((3, 8 * time.size)), np.int64(0), 1.0 / slowness
    value = 0.0
    slower = 0.0
    for knot in range(time.size):
        now, end = time[knot], time[min(knot + 1, last)]
        goal, slope = load[knot], 0.0
        if knot < last and end > now:
            slope = (load[knot + 1] - goal) / (end - now)
        if knot == last:
            end = np.inf
        while now < end:
            knots[0, count], knots[1, count], knots[2, count] = now, value, slower
            count += 1
            gap = goal - value
            if gap == 0.0 and abs(slope) <= rate:  # it follows
                if knot < last:
                    value = load[knot + 1]
                break
            way = math.copysign(1.0, gap if gap != 0.0 else slope)
            closing, span = rate - way * slope, end - now
            caught = gap != 0.0 and closing > 0.0 and way * gap <= closing * span
            if caught:
                span = way * gap / closing
            now = now + span if caught else end
            value += way * rate * span
            slower -= way * span * rate * rate
            goal += slope * span
            if caught:
                knots[0, count], knots[1, count], knots[2, count] = now, goal, slower
                count += 1
                value, slower = goal, 0.0
    return knots[0, :count].copy(), knots[1, :count].copy(), knots[2, :count].copy()


def _build_forms(setting: Setting) -> list[Form] | str:
    if not setting.load_known:
        return "there is no load log to compare with"
    largest = float(setting.largest_torque.max())
    most = positive(
        "saturation",
        3.0,
        high=1e4,
        floor=2e-3,
        report={"limit": lambda b, _: max(b, 1e-6) ** (-1.0 / POWER)},
    )
    rise = positive(
        "rise_time_s",
        0.05 * setting.duration,
        high=setting.duration,
        floor=setting.time_floor,
        report={"rate_per_s": lambda time, _: 1.0 / max(time, 1e-3 * setting.time_floor)},
    )

    def fill_saturation(values: Values) -> dict:
        return {"load_saturation": values["saturation"], "load_reference": largest}

    def fill_rate(values: Values) -> dict:
        return {"load_slowness": values["rise_time_s"] / largest}

    law = Law("load_law", "load_nm", largest, 0.3, terms=5)
    saturation = Form("saturation", (most,), fill_saturation)
    if setting.step_gap > SELDOM * setting.interval:
        # a law of loads that the finger passed between two rows would only bend the line there
        return [saturation]
    return [
        saturation,
        Form("rate", (rise,), fill_rate),
        *_list_fading(setting),
        free_form(law, {"load_reference": largest}),
    ]


def _list_fading(setting: Setting) -> list[Form]:
    """List the forms of a load that fades."""
    if not (setting.levels or setting.reversals):
        return []  # under one load that is creep
    known = {
        "load_fade_reference": float(setting.largest_torque.max()),
        "load_fade_time": setting.duration,
    }
    lost = positive("lost_share", 0.2, high=0.9, floor=2e-3)

    def fade(values: Values) -> dict:
        return {"load_fade": values["lost_share"], **known}

    def sag(values: Values) -> dict:
        return {"load_sag": values["lost_share"], **known}

    return [Form("fading", (lost,), fade), Form("sagging", (lost,), sag)]


EFFECT = Effect(
    "load_limit",
    "the logged load is not reached",
    "within_trial",
    _build_forms,
    hooks=(
        Hook("limit", saturate, ("load_saturation", "load_law")),
        Hook("log", reach_log, ("load_slowness", "load_fade", "load_sag")),
        Hook("jump", slow_jump, ("load_slowness",)),
    ),
)
