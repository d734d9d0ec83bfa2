"""The load that acts: the log through a lag of one stage, or of two in a row."""

import math

from numpy.typing import NDArray

from softfinger.mechanics.compiled import compiled
from softfinger.mechanics.forward.slots import CHAIN_SLOTS
from softfinger.mechanics.forward.work import START, Model, Work

_LAG, _SECOND = CHAIN_SLOTS.index("lag"), CHAIN_SLOTS.index("lag_second_share")
VALUE, SLOPE, ACTING, _FIRST = range(4)
"""Of a segment's load: the log's value and slope at its start, the load that acts then, and what is
behind the first stage of two."""


@compiled
def fill_load(
    model: Model, work: Work, i: int, load: NDArray, d_acting: NDArray, since: float
) -> None:
    """Write the load that acts `since` seconds into a segment: the log through a lag."""
    nodes, lag, slope = work.nodes, model.chain[_LAG], load[SLOPE]
    if lag > 0.0 and model.chain[_SECOND] > 0.0:
        _fill_load_of_two_stages(model, work, i, load, d_acting, since)
        return
    if lag > 0.0:
        decay = math.exp(-since / lag)
        gap = load[ACTING] - load[VALUE] + lag * slope
        nodes.load[i] = load[VALUE] + slope * (since - lag) + gap * decay
        by_lag = slope * (decay - 1.0) + gap * decay * since / (lag * lag)
    else:
        decay, by_lag = 0.0, -slope
        nodes.load[i] = load[VALUE] + slope * since
    for c in range(d_acting.shape[1]):
        nodes.d_load[i, c] = by_lag * model.d_chain[c, _LAG] + decay * d_acting[0, c]


@compiled
def _fill_load_of_two_stages(
    model: Model, work: Work, i: int, load: NDArray, d_acting: NDArray, since: float
) -> None:
    """Write the load behind two lags l₁ > l₂ in a row, the log v + st before them.

    v + s (t − l₁ − l₂) + A exp(−t/l₁) + B exp(−t/l₂), where A is what the first stage lacks at the
    start times l₁/(l₁ − l₂), and B what then remains to the load that acts.
    """
    nodes, slope = work.nodes, load[SLOPE]
    lag, share = model.chain[_LAG], model.chain[_SECOND]
    first, second = lag * (1.0 - share), lag * share
    apart = first - second
    lack = load[_FIRST] - load[VALUE] + slope * first
    slow = lack * first / apart
    fast = load[ACTING] - load[VALUE] + slope * lag - slow
    decay, fading = math.exp(-since / first), math.exp(-since / second)
    nodes.load[i] = load[VALUE] + slope * (since - lag) + slow * decay + fast * fading
    for c in range(d_acting.shape[1]):
        d_lag = model.d_chain[c, _LAG]
        d_second = d_lag * share + lag * model.d_chain[c, _SECOND]
        d_first = d_lag - d_second
        d_lack = d_acting[1, c] + slope * d_first
        d_slow = d_lack * first + lack * (first * d_second - second * d_first) / apart
        d_slow /= apart
        d_fast = d_acting[0, c] + slope * d_lag - d_slow
        nodes.d_load[i, c] = (
            (d_slow + slow * since * d_first / (first * first)) * decay
            + (d_fast + fast * since * d_second / (second * second)) * fading
            - slope * d_lag
        )


@compiled
def advance_acting(
    model: Model, work: Work, load: NDArray, d_acting: NDArray, since: float
) -> None:
    """Take the load that acts, and its tangents (stage, column), to the end of a segment."""
    fill_load(model, work, START, load, d_acting, since)
    if model.chain[_SECOND] > 0.0:
        _advance_first_stage(model, load, d_acting, since)
    load[ACTING] = work.nodes.load[START]
    d_acting[0] = work.nodes.d_load[START]


@compiled
def _advance_first_stage(model: Model, load: NDArray, d_acting: NDArray, since: float) -> None:
    """Take what is behind the first stage of two to the end of a segment."""
    slope, lag, share = load[SLOPE], model.chain[_LAG], model.chain[_SECOND]
    first = lag * (1.0 - share)
    decay = math.exp(-since / first)
    lack = load[_FIRST] - load[VALUE] + slope * first
    load[_FIRST] = load[VALUE] + slope * (since - first) + lack * decay
    by_first = slope * (decay - 1.0) + lack * decay * since / (first * first)
    for c in range(d_acting.shape[1]):
        d_first = model.d_chain[c, _LAG] * (1.0 - share) - lag * model.d_chain[c, _SECOND]
        d_acting[1, c] = by_first * d_first + decay * d_acting[1, c]
