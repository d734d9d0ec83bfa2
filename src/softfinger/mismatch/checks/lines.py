"""Waves in what a model leaves.

At one frequency, every trial has too much power.

A trial's residual, whitened as an AR(1) series, has power P ~ χ²₂ at every frequency. A wave of
normal amplitude, with a phase of its own in each trial, makes it (1 + g) χ²₂, so that a trial's
evidence is ½ P g / (1 + g) − log(1 + g) nats. It is summed over trials and averaged over sizes g,
frequencies and shapes: a wave in one joint, or in all.
"""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.stats import chi2

from softfinger.inference.problem import Problem
from softfinger.measurement.memory import Memory, list_memories, whiten_array
from softfinger.mismatch.budget import BUDGET
from softfinger.mismatch.decisions import DECISIONS
from softfinger.mismatch.priors import PRIORS


class Line(NamedTuple):
    """The strongest line.

    Frequency [Hz], joint from 1, corrected p-value, evidence [nats].

    Joint 0 is all joints together, as the load moves them.
    """

    frequency_hz: float
    joint: int
    p_value: float
    gain: float


class WaveSeries(NamedTuple):
    """What shows a wave in one trial.

    The residual of one joint, or a weighted sum of all.

    Attributes
    ----------
    trial, shape
        Places in the residual and in `list_shapes`.
    time
        (n,) [s].
    gap
        (n − 1,) between them, in median frame intervals.
    memory
        That by which a wave is whitened.
    values
        (n,) white, of mean 0 and variance 1.
    per_rad
        What 1 rad of the shape moves them by, before it is whitened.
    """

    trial: int
    shape: int
    time: NDArray[np.float64]
    gap: NDArray[np.float64]
    memory: Memory
    values: NDArray[np.float64]
    per_rad: float


def find_line(problem: Problem, residual: NDArray[np.float64], time: NDArray[np.float64]) -> Line:
    """Find the strongest spectral line.

    It is of one joint, or of all as the load moves them.

    Parameters
    ----------
    residual
        (trial, joint, frame) [rad], NaN where not used.
    time
        (trial, frame) [s].
    """
    frequency = list_frequencies(problem)
    power, gain, count = scan_series(list_series(problem, residual, time), frequency)
    tail = np.array([chi2.sf(p, 2 * max(n, 1)) for p, n in zip(power, count, strict=True)])
    shape, place = np.unravel_index(np.argmin(tail), tail.shape)
    looks = tail.size
    p_value = -np.expm1(looks * np.log1p(-min(tail[shape, place], 1 - 1e-16)))
    evidence = float(np.logaddexp.reduce(gain, axis=None) - np.log(gain.size))
    joint = int(shape + 1) % (problem.setting.stiffness.size + 1)
    return Line(float(frequency[place]), joint, float(min(1.0, p_value)), evidence)


def list_frequencies(problem: Problem) -> NDArray[np.float64]:
    """List the frequencies [Hz] that are tried."""
    interval, duration = problem.trials.interval, problem.setting.duration
    low, high = DECISIONS.wave_periods / duration, 0.45 / interval
    count = int(min(BUDGET.frequencies, max(2 * (high - low) * duration, 1)))
    return np.linspace(low, high, count)


def scan_series(
    series: list[list[WaveSeries]], frequency: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.int64]]:
    """Scan series for waves.

    Power (shape, frequency), evidence (size, shape, frequency), and trials (shape,) behind it.
    The power is χ²₂ in each trial where there is noise alone.
    """
    power = np.zeros((len(series), len(frequency)))
    gain = np.zeros((len(PRIORS.wave_sizes), *power.shape))
    for k, trials in enumerate(series):
        for one in trials:
            wave = transform_series(one.values, one.time, frequency)
            here = 2.0 * np.abs(wave) ** 2 / one.values.size
            power[k] += here
            for size, gained in zip(PRIORS.wave_sizes, gain, strict=True):
                gained[k] += 0.5 * here * size / (1.0 + size) - np.log1p(size)
    return power, gain, np.array([len(trials) for trials in series])


def list_shapes(stiffness: NDArray[np.float64]) -> NDArray[np.float64]:
    """List how far a wave moves the joints.

    (shape, joint): each alone, then all by a load.

    >>> list_shapes(np.array([1.0, 2.0]))
    array([[1. , 0. ],
           [0. , 1. ],
           [1. , 0.5]])
    """
    alone = np.eye(stiffness.size)
    return np.vstack([alone, stiffness.min() / stiffness]) if stiffness.size > 1 else alone


def list_series(
    problem: Problem, residual: NDArray[np.float64], time: NDArray[np.float64]
) -> list[list[WaveSeries]]:
    """List the series of every shape and trial.

    Only those in which enough was seen.

    What neighbouring joints have in common, they get from the link between them: a wave in all
    joints is clear in their weighted sum (generalised least squares) and hardly in any one.
    """
    shapes = list_shapes(problem.setting.stiffness)
    found: list[list[WaveSeries]] = [[] for _ in shapes]
    for i in range(len(residual)):
        for one in _weigh_joints(problem, residual[i], time[i], shapes, i):
            found[one.shape].append(one)
    return found


def _weigh_joints(
    problem: Problem,
    residual: NDArray[np.float64],
    time: NDArray[np.float64],
    shapes: NDArray[np.float64],
    trial: int,
) -> Iterator[WaveSeries]:
    seen = np.isfinite(residual).sum(axis=1) >= DECISIONS.wave_frames
    used = np.isfinite(residual[seen]).all(axis=0)
    if not seen.any() or used.sum() < DECISIONS.wave_frames:
        return
    gap = np.diff(time[used]) / problem.trials.interval
    memories = [list_memories(problem.noise)[j] for j in np.flatnonzero(seen)]
    pairs = zip(residual[seen][:, used], memories, strict=True)
    white = np.array([whiten_series(values, gap, memory) for values, memory in pairs])
    white -= white.mean(axis=1, keepdims=True)
    scale = white.std(axis=1)
    correlation = problem.noise["noise_correlation"].values[np.ix_(seen, seen)]
    for k, shape in enumerate(shapes):
        if not shape[~seen].any():
            weight = np.linalg.solve(correlation, shape[seen] / scale) / scale
            values = weight @ white
            sd = values.std()  # its own variance is the measure: a model's may be wrong
            kept = memories[int(np.abs(shape[seen]).argmax())]
            yield WaveSeries(trial, k, time[used], gap, kept, values / sd, float(sd))


def transform_series(
    values: NDArray[np.float64], time: NDArray[np.float64], frequency: NDArray[np.float64]
) -> NDArray[np.complex128]:
    """Fourier sums at uneven times.

    Σ v exp(−2πi f t), at evenly spaced frequencies.

    A frequency is a coarse step and a fine one, so that few exponentials make all waves.

    >>> transform_series(np.ones(2), np.array([0.0, 1.0]), np.array([0.0, 0.5, 1.0])).real.round(9)
    array([2., 0., 2.])
    """
    count = int(np.ceil(np.sqrt(len(frequency))))
    fine = np.exp(-2j * np.pi * np.outer(time, frequency[:count] - frequency[0]))
    coarse = np.exp(-2j * np.pi * np.outer(frequency[::count], time))
    return ((coarse * values) @ fine).ravel()[: len(frequency)]


def whiten_series(
    values: NDArray[np.float64] | NDArray[np.complex128], gap: NDArray[np.float64], memory: Memory
) -> NDArray[np.float64] | NDArray[np.complex128]:
    """Whiten a series (n,), real or complex, whose noise has a memory.

    The gaps (n − 1,) are in median frame intervals.

    >>> whiten_series(np.array([1.0, 1.0]), np.array([1.0]), Memory(0.6)).round(9)
    array([1. , 0.5])
    """
    rows = np.stack([values.real, values.imag], axis=1)
    white = whiten_array(rows, np.insert(gap, 0, np.inf), memory)[0]
    return white[:, 0] + 1j * white[:, 1] if np.iscomplexobj(values) else white[:, 0]
