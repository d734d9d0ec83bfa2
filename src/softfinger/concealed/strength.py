"""Strengths by which the oracle gains some evidence."""

import numpy as np

from softfinger.concealed.oracle import expect_gain
from softfinger.concealed.registry import EFFECTS
from softfinger.concealed.setting import (
    Setting,
    choose_trials,
    record_cleanly,
    set_strengths,
)

LEAST_NATS, MOST_NATS = 1.0, 10_000.0
OFFSET_NATS = 10.0  # below it, evidence may be negative: what an idle parameter costs
CLOSE = 0.1  # relative
EVALUATIONS = 8
WITHIN_TRIALS, BETWEEN_TRIALS = 6, 40  # trials that represent the whole campaign


def expect_effect_gain(effect: str, strength: float, setting: Setting) -> float:
    """Evidence [nats] to expect from one effect's strength."""
    count = len(setting.trials)
    few = BETWEEN_TRIALS if EFFECTS[effect].level == "between_trials" else WITHIN_TRIALS
    chosen = choose_trials(count, few)
    doses = set_strengths({effect: setting.doses[effect]}, {effect: strength})
    return expect_gain(
        record_cleanly(setting, doses, chosen),
        setting.rig,
        setting.noise,
        doses,
        setting.individuals[chosen],
        times=count / chosen.size,
    )


def find_reach(effect: str, setting: Setting) -> float:
    """Largest evidence [nats] of an effect here."""
    return expect_effect_gain(effect, EFFECTS[effect].largest, setting)


def calibrate_strength(effect: str, setting: Setting, target: float, reach: float) -> float:
    """Strength at which the oracle gains `target` nats.

    The gain grows about as the square of the strength, so a secant on doubly logarithmic scales
    closes in within a few steps.

    Parameters
    ----------
    reach : float [nats]
        From `find_reach`.
    """
    largest = EFFECTS[effect].largest
    if target >= reach:
        return largest
    aim = np.log(target + OFFSET_NATS)

    def scale(gain: float) -> float:
        return np.log(max(gain + OFFSET_NATS, 0.1))

    high, high_value = np.log(largest), scale(reach)
    low, low_value = -np.inf, -np.inf
    at = high - 0.5 * (high_value - np.log(target + OFFSET_NATS)) - 0.2
    for _ in range(EVALUATIONS):
        value = scale(expect_effect_gain(effect, float(np.exp(at)), setting))
        if abs(np.expm1(value - aim)) < CLOSE:
            break
        if value > aim:
            high, high_value = at, value
        else:
            low, low_value = at, value
        if np.isinf(low):
            at = high - max(0.3, 0.6 * (high_value - aim))
        else:
            share = np.clip((aim - low_value) / (high_value - low_value), 0.1, 0.9)
            at = low + share * (high - low)
    return float(np.exp(at))


def place_strengths(
    places: dict[str, float], setting: Setting, *, even: bool = False
) -> tuple[dict[str, float], dict[str, float]]:
    """Strength of every effect, and its target gain [nats].

    The target is the gain of the effect alone.

    Parameters
    ----------
    places : dict of float
        For every effect its place, from 0 to 1 on a logarithmic scale, between one nat and its
        reach; below 0: its strength is zero. Where even the largest strength does not reach a nat,
        it is the largest.
    even : bool
        The smallest reach of them counts for all, so that none drowns another.
    """
    drawn = [name for name, place in places.items() if place >= 0.0]
    reach = {name: find_reach(name, setting) for name in drawn}
    tops = {name: min(reach.values()) if even else reach[name] for name in drawn}
    strengths, aims = dict.fromkeys(places, 0.0), dict.fromkeys(places, 0.0)
    for name in drawn:
        top = np.clip(tops[name], LEAST_NATS, MOST_NATS)
        aims[name] = float(LEAST_NATS * (top / LEAST_NATS) ** places[name])
        strengths[name] = calibrate_strength(name, setting, aims[name], reach[name])
    return strengths, aims
