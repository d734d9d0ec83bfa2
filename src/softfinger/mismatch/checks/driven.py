"""What follows the load in what a model leaves.

Rings and resonances: oscillators that the load drives and that forget; two of them, one for its
rises and one for its falls, as a finger that is let go rings in another way; waves that are as
large as the load; and what moves as the load and its rate do. Each has a gain for every trial, or
one for all. What has the hum's frequency pays for its choice as the hum does. An oscillator of
another frequency does not: what moves with a load that swings has no frequency of its own.
"""

import numpy as np
from numpy.typing import NDArray

from softfinger.inference.problem import Problem
from softfinger.mismatch.budget import BUDGET
from softfinger.mismatch.checks.lines import WaveSeries
from softfinger.mismatch.checks.waves import (
    Array,
    average_evidence,
    project_wave,
    weigh_wave,
)
from softfinger.mismatch.decisions import DECISIONS
from softfinger.mismatch.priors import PRIORS


def weigh_driven(
    problem: Problem, series: list[WaveSeries], tried: tuple[float, float], sizes: Array
) -> float:
    """Evidence [nats] for what follows the load.

    Parameters
    ----------
    series
        Of one shape, one for each trial.
    tried
        The frequency [Hz] that was chosen, and what its choice costs [nats].
    sizes
        [rad] of the amplitudes that are as likely.
    """
    chosen, cost = tried
    kinds = [list_driven(problem, one, chosen) for one in series]
    every = np.concatenate(kinds)
    power = [2.0 * np.mean(part**2, axis=0) for part in (every.real, every.imag)]
    real, imag = (np.sqrt(np.fmax(part, 1e-300)) for part in power)  # as strong as a hum
    alike = [one.real / real + 1j * one.imag / imag for one in kinds]

    def weigh(groups: list[list[int]]) -> float:
        products = [project_wave(series, [a[:, group] for a in alike]) for group in groups]
        both = [[weigh_wave(p, sizes), weigh_wave(p.share_gain(), sizes)] for p in products]
        return average_evidence(np.array(both))

    tuned, other = _group_kinds(every.shape[1])
    return float(np.logaddexp(weigh(tuned) - cost, weigh(other)))


def _group_kinds(count: int) -> tuple[list[list[int]], list[list[int]]]:
    """Columns of `list_driven` that act together: of the chosen frequency, and others."""
    number = len(PRIORS.ring_periods)
    ways = [[k, number + k] for k in range(number)]
    alone = [[k] for k in range(2 * number, count)]
    return [*ways, *alone[: number + 1]], alone[number + 1 :]


def list_driven(problem: Problem, series: WaveSeries, chosen: float) -> NDArray[np.complex128]:
    """List what follows a load (frame, kind).

    First rings of the chosen frequency [Hz]: by rises, by falls, by both, each with every time of
    decay; then the wave as large as the load, rings of other frequencies, and what moves with it.
    """
    known = problem.trials.load_time[series.trial], problem.trials.load_torque[series.trial]
    time, load = series.time, np.interp(series.time, *known)
    low, high = DECISIONS.wave_periods / problem.setting.duration, 0.45 / problem.trials.interval
    frequency = np.append(chosen, np.linspace(low, high, BUDGET.ring_frequencies))
    periods = np.array(PRIORS.ring_periods)
    every = np.repeat(frequency, len(periods))
    rings = drive_oscillators(time, load, every, np.tile(periods, len(frequency)) / every)
    change = np.diff(load, prepend=0.0)
    one_way = [
        drive_oscillators(time, np.cumsum(part), every[: len(periods)], periods / chosen)
        for part in (np.maximum(change, 0.0), np.minimum(change, 0.0))
    ]
    loaded = load * np.exp(2j * np.pi * chosen * time)
    follows = load + 1j * np.gradient(load, time)
    own = *one_way, rings[:, : len(periods)], loaded[:, None]
    return np.concatenate([*own, rings[:, len(periods) :], follows[:, None]], axis=1)


def drive_oscillators(
    time: Array, load: Array, frequency: Array, decay: Array
) -> NDArray[np.complex128]:
    """Move oscillators (frame, k) by a load (frame,).

    Of some frequencies [Hz] and decay times [s]:

    ∫ L'(s) exp((2πi f − 1/τ)(t − s)) ds, the load having come from zero at the first frame.

    >>> time, one = np.arange(3.0), np.ones(1)
    >>> drive_oscillators(time, np.array([0.0, 1.0, 1.0]), 0.5 * one, one)[:, 0].real.round(3)
    array([ 0.   ,  1.   , -0.368])
    """
    turn = np.exp(np.outer(np.diff(time), 2j * np.pi * frequency - 1.0 / decay))
    moved = np.empty((len(time), len(frequency)), complex)
    moved[0] = load[0]
    for i, rise in enumerate(np.diff(load)):
        moved[i + 1] = turn[i] * moved[i] + rise
    return moved
