"""A free impulse response from the log to the load.

It is causal, and not negative.

A share m_k of the log arrives evenly spread between two delays, the rest at once:

    u(t) (1 − Σ m_k) + Σ m_k ∫ u(t − s) ds / (d_k+1 − d_k),   s from d_k to d_k+1.

A step becomes straight lines, so it is exact for what is held. A ramp begins by parabolas, which
are met at four knots for each of those delays.
"""

from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from softfinger.compiled import compiled
from softfinger.mechanics.effects.effect import FREE, Form, Setting, Values, positive
from softfinger.mechanics.forward.curve import KNOTS
from softfinger.mechanics.forward.hooks import Hook
from softfinger.mechanics.forward.slot import Slot, declare
from softfinger.mechanics.forward.work import Model

EDGES = np.array([0.0, 0.5, 1.0, 2.0, 4.0, 8.0, 16.0, 32.0, 64.0])
"""Delays between which a share arrives, in frame intervals."""
FINE = np.concatenate([np.linspace(a, b, 5)[:4] for a, b in pairwise(EDGES)])
SHARE = 0.3  # prior scale of each
USUAL = 5.0  # frame intervals, beyond which a share is the rarer the later it comes, as is a lag
DENSE = 48  # knots of a log from which no more are needed

_RESPONSE, _UNIT = declare(
    response=Slot("law", "1", 0.0, "share of the log that arrives between two delays: of joint 1"),
    response_unit=Slot(
        "chain", "s", 1.0, "unit of those delays, a frame interval", "positive", constant=True
    ),
)


@compiled
def spread_log(model: Model, time: NDArray, load: NDArray) -> tuple[NDArray, NDArray, NDArray]:
    """The log behind its response, with its changes."""
    share, delay = model.law[0, _RESPONSE], EDGES * model.chain[_UNIT]
    area = np.zeros(time.size)
    for k in range(1, time.size):
        area[k] = area[k - 1] + 0.5 * (load[k - 1] + load[k]) * (time[k] - time[k - 1])
    moment = _list_moments(time, load, model.chain[_UNIT])
    count, columns = 0, model.d_chain.shape[0]
    knots, changes = np.zeros((2, 2 * moment.size)), np.zeros((2 * moment.size, columns))
    mean = np.zeros(delay.size - 1)
    for at in moment:
        for k in range(mean.size):
            before = _integrate(time, load, area, at - delay[k + 1])
            mean[k] = (_integrate(time, load, area, at - delay[k]) - before) / (
                delay[k + 1] - delay[k]
            )
        sides = np.searchsorted(time, at, side="left"), np.searchsorted(time, at, side="right")
        jumps = sides[1] - sides[0] > 1  # two knots at this moment
        for after in range(0 if jumps and at > time[0] else 1, 2):
            now = load[sides[0]] if after == 0 else _evaluate(time, load, at)
            knots[0, count], knots[1, count] = at, now
            for k in range(mean.size):
                knots[1, count] += share[k] * (mean[k] - now)
                for c in range(columns):
                    changes[count, c] += model.d_law[c, 0, _RESPONSE, k] * (mean[k] - now)
            count += 1
    return knots[0, :count].copy(), knots[1, :count].copy(), changes[:count].copy()


@compiled
def _list_moments(time: NDArray, load: NDArray, unit: float) -> NDArray:
    """Where the load may turn: knots and their echoes."""
    if time.size > DENSE:
        return np.unique(time)
    turns = np.unique((time.reshape(-1, 1) + unit * EDGES).ravel())
    if np.any((np.diff(time) > 0.0) & (np.diff(load) != 0.0)):  # a ramp
        return np.unique(np.append(turns, (time.reshape(-1, 1) + unit * FINE).ravel()))
    return turns


@compiled
def _evaluate(time: NDArray, load: NDArray, at: float) -> float:
    """The log at a moment, after its jump."""
    k = np.searchsorted(time, at, side="right") - 1
    if k < 0:
        return 0.0
    if k == time.size - 1:
        return load[k]
    return load[k] + (at - time[k]) / (time[k + 1] - time[k]) * (load[k + 1] - load[k])


@compiled
def _integrate(time: NDArray, load: NDArray, area: NDArray, at: float) -> float:
    """The log's integral up to a moment, from those (knot,)."""
    k = np.searchsorted(time, at, side="right") - 1
    if k < 0:
        return 0.0
    return area[k] + 0.5 * (load[k] + _evaluate(time, load, at)) * (at - time[k])


RESPONSE = Hook("log", spread_log, ("response",))


def build_response(setting: Setting) -> Form:
    """Build the free form of a lag."""
    middle = 0.5 * (EDGES[1:] + EDGES[:-1])
    sizes = SHARE * np.minimum(1.0, USUAL / middle)
    least = setting.time_floor / (middle * setting.interval)
    floors = np.maximum(2e-3 * sizes, np.minimum(least, 0.5))
    shares = tuple(
        positive(f"share_late_by_{k}", float(size), high=1.0, floor=float(floor), term=True)
        for k, (size, floor) in enumerate(zip(sizes, floors, strict=True), start=1)
    )

    def fill(values: Values) -> dict:
        mass = np.zeros(KNOTS)
        mass[: len(shares)] = [values[p.name] for p in shares]
        return {"response": mass / max(1.0, mass.sum()), "response_unit": setting.interval}

    return Form(FREE, shares, fill)
