"""Kinds of load protocols, each with continuous parameters.

Every parameter is a place from 0 to 1. The first is the largest load, as a share of the limit.
"""

from collections.abc import Callable, Mapping
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from softfinger.mismatch.budget import BUDGET
from softfinger.mismatch.experiment.limits import RigLimits, hold_limits
from softfinger.mismatch.experiment.protocols import PlannedProtocol
from softfinger.mismatch.priors import PRIORS

Places = NDArray[np.float64]
Histories = list[tuple[NDArray[np.float64], NDArray[np.float64]]]


class LoadShape(NamedTuple):
    """One kind of protocol.

    `build` makes histories, of loads from 0 to 1, of places (k,) and the duration [s].
    """

    parameters: tuple[str, ...]
    build: Callable[[Places, float], Histories]


def list_shapes() -> Mapping[str, LoadShape]:
    """List the kinds that a plan is chosen from.

    >>> list(list_shapes())
    ['step', 'levels', 'staircase', 'triangle', 'sine', 'chirp', 'telegraph']
    """
    stairs = tuple(f"level_{k + 1}" for k in range(BUDGET.stairs))
    return {
        "step": LoadShape(("peak",), _step),
        "levels": LoadShape(("peak", "lowest", "release"), _levels),
        "staircase": LoadShape(("peak", *stairs), _staircase),
        "triangle": LoadShape(("peak", "speed", "turn"), _triangle),
        "sine": LoadShape(("peak", "speed", "depth"), _sine),
        "chirp": LoadShape(("peak", "slowest", "fastest"), _chirp),
        "telegraph": LoadShape(("peak", "speed", "low"), _telegraph),
    }


def build_protocol(name: str, places: Places, limits: RigLimits) -> PlannedProtocol:
    """Build a protocol of a kind within a rig's limits.

    Parameters
    ----------
    places
        (k,) of its parameters, 0 to 1.
    """
    places = np.clip(places, 0.0, 1.0)
    shape = list_shapes()[name]
    low = PRIORS.least_load
    peak = limits.load * (low + (1.0 - low) * places[0])
    histories = shape.build(places[1:], limits.duration)
    return hold_limits([(time, peak * load) for time, load in histories], limits)


def list_generic(limits: RigLimits) -> dict[str, PlannedProtocol]:
    """Protocols that anyone would record, at the largest load."""
    middle = {
        "step": [1.0],
        "levels": [1.0, 0.25, 0.5],
        "staircase": [1.0, 0.35, 0.7, 1.0, 0.6, 0.3, 0.9],
        "triangle": [1.0, 0.3, 0.0],
    }
    return {name: build_protocol(name, np.array(p), limits) for name, p in middle.items()}


def _step(places: Places, duration: float) -> Histories:
    return [(np.array([0.0, duration]), np.ones(2))]


def _levels(places: Places, duration: float) -> Histories:
    lowest, release = 0.15 + 0.85 * places[0], (0.2 + 0.7 * places[1]) * duration
    time = np.array([0.0, release, release, duration])
    return [
        (time, level * np.array([1.0, 1.0, 0.0, 0.0]))
        for level in np.linspace(lowest, 1.0, BUDGET.levels_planned)
    ]


def _staircase(places: Places, duration: float) -> Histories:
    edges = np.repeat(np.linspace(0.0, duration, len(places) + 1), 2)[1:-1]
    return [(edges, np.repeat(places / max(places.max(), 1e-6), 2))]


def _triangle(places: Places, duration: float) -> Histories:
    """Rises and falls; falls end at a share of the peak."""
    halves = 2 * int(np.round(_place(places[0], 1.0, BUDGET.fastest_cycles)))
    time = np.linspace(0.0, duration, halves + 1)
    load = np.where(np.arange(halves + 1) % 2 == 1, 1.0, 0.7 * places[1])
    load[0] = 0.0
    return [(time, load)]


def _sine(places: Places, duration: float) -> Histories:
    cycles = _place(places[0], 1.0, BUDGET.fastest_cycles)
    time = np.linspace(0.0, duration, int(np.ceil(cycles * BUDGET.cycle_knots)) + 1)
    depth = 0.1 + 0.9 * places[1]
    return [(time, 1.0 - 0.5 * depth * (1.0 + np.cos(2 * np.pi * cycles * time / duration)))]


def _chirp(places: Places, duration: float) -> Histories:
    """A sine whose frequency grows in equal ratios."""
    slow = _place(places[0], 0.5, BUDGET.fastest_cycles)
    fast = _place(places[1], 0.5, BUDGET.fastest_cycles) * 1.001
    growth = np.log(fast / slow)
    turns = slow * np.expm1(growth) / growth
    phase = np.linspace(0.0, turns, int(np.ceil(turns * BUDGET.cycle_knots)) + 1)
    time = duration * np.log1p(phase * growth / slow) / growth
    return [(time, 0.5 * (1.0 - np.cos(2 * np.pi * phase)))]


def _telegraph(places: Places, duration: float) -> Histories:
    """Jumps between two levels at random times, always the same."""
    count = int(np.round(_place(places[0], 3.0, 2.0 * BUDGET.fastest_cycles)))
    waits = np.random.default_rng(count).exponential(size=count)
    edges = np.r_[0.0, np.cumsum(waits) / waits.sum()] * duration
    load = np.where(np.arange(count) % 2 == 0, 1.0, 0.8 * places[1])
    return [(np.repeat(edges, 2)[1:-1], np.repeat(load, 2))]


def _place(share: float, low: float, high: float) -> float:
    """Place between two numbers, in equal ratios."""
    return float(low * (high / low) ** share)
