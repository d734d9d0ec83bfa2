"""The load that acts: the log through a largest rate, a lag of one stage or two, and a limit."""

import math

from numpy.typing import NDArray

from softfinger.compiled import compiled
from softfinger.mechanics.forward.curve import combine, weigh_slope, weigh_value
from softfinger.mechanics.forward.slots import CHAIN_SLOTS, LAWS
from softfinger.mechanics.forward.work import HAS_LIMIT, START, Model, Work

_LAG, _SECOND = CHAIN_SLOTS.index("lag"), CHAIN_SLOTS.index("lag_second_share")
_SLOWNESS = CHAIN_SLOTS.index("load_slowness")
_SATURATION, _REFERENCE = CHAIN_SLOTS.index("load_saturation"), CHAIN_SLOTS.index("load_reference")
_LAW = LAWS.index("load_law")
_SHARP = 8.0  # power of the saturation
VALUE, SLOPE, ACTING, _FIRST, D_VALUE, D_SLOPE = range(6)
"""Of a segment's load: the log's value and slope at its start, the load that acts then, what is
behind the first stage of two, and value and slope of the log's derivative by the slowness."""


@compiled
def fill_load(
    model: Model, work: Work, i: int, load: NDArray, d_acting: NDArray, since: float
) -> None:
    """Write the load that acts `since` seconds into a segment: the log through a lag."""
    nodes, lag, slope = work.nodes, model.chain[_LAG], load[SLOPE]
    ahead, climb = load[D_VALUE] + load[D_SLOPE] * (since - lag), load[D_SLOPE]
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
        slower = model.d_chain[c, _SLOWNESS]
        d_gap = d_acting[0, c] + (lag * climb - load[D_VALUE]) * slower
        nodes.d_load[i, c] = by_lag * model.d_chain[c, _LAG] + ahead * slower + decay * d_gap


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
        slower = model.d_chain[c, _SLOWNESS]
        value, climb = load[D_VALUE] * slower, load[D_SLOPE] * slower
        d_lack = d_acting[1, c] - value + climb * first + slope * d_first
        d_slow = d_lack * first + lack * (first * d_second - second * d_first) / apart
        d_slow /= apart
        d_fast = d_acting[0, c] - value + climb * lag + slope * d_lag - d_slow
        nodes.d_load[i, c] = (
            (d_slow + slow * since * d_first / (first * first)) * decay
            + (d_fast + fast * since * d_second / (second * second)) * fading
            - slope * d_lag
            + value
            + climb * (since - lag)
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
        slower = model.d_chain[c, _SLOWNESS]
        value, climb = load[D_VALUE] * slower, load[D_SLOPE] * slower
        d_lack = d_acting[1, c] - value + climb * first
        d_acting[1, c] = by_first * d_first + decay * d_lack + value + climb * (since - first)


@compiled
def limit_load(model: Model, load: float) -> tuple[float, float]:
    """What the limit leaves of a load: u (1 + b (|u|/r)^8)^{−1/8} (1 + law of |u|); its slope."""
    if not model.groups[HAS_LIMIT]:
        return load, 1.0
    x = abs(load) / model.chain[_REFERENCE]
    bent = 1.0 + model.chain[_SATURATION] * x**_SHARP
    kept, law = bent ** (-1.0 / _SHARP), model.law[0, _LAW]
    factor = 1.0 + combine(law, weigh_value(x))
    return load * kept * factor, kept * (factor / bent + x * combine(law, weigh_slope(x)))


@compiled
def limit_node(model: Model, work: Work, i: int) -> None:
    """Put the limit on the load at a node, and on its tangents."""
    nodes, load = work.nodes, work.nodes.load[i]
    nodes.load[i], slope = limit_load(model, load)
    x = abs(load) / model.chain[_REFERENCE]
    bent, weights = 1.0 + model.chain[_SATURATION] * x**_SHARP, weigh_value(x)
    by_law = load * bent ** (-1.0 / _SHARP)
    by_saturation = -nodes.load[i] * x**_SHARP / (_SHARP * bent)
    for c in range(model.d_chain.shape[0]):
        change = by_saturation * model.d_chain[c, _SATURATION]
        change += by_law * combine(model.d_law[c, 0, _LAW], weights)
        nodes.d_load[i, c] = slope * nodes.d_load[i, c] + change
