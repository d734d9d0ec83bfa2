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
    interval, duration = problem.trials.interval, problem.setting.duration
    low, high = DECISIONS.wave_periods / duration, 0.45 / interval
    count = int(min(BUDGET.frequencies, max(2 * (high - low) * duration, 1)))
    frequency = np.linspace(low, high, count)
    shapes = list_shapes(problem.setting.stiffness)
    power = np.zeros((len(shapes), count))
    gain = np.zeros((len(PRIORS.wave_sizes), *power.shape))
    series = np.zeros(len(shapes), int)
    for i in range(len(residual)):
        for k, here in measure_power(problem, residual[i], time[i], frequency, shapes):
            power[k] += here
            for size, gained in zip(PRIORS.wave_sizes, gain, strict=True):
                gained[k] += 0.5 * here * size / (1.0 + size) - np.log1p(size)
            series[k] += 1
    tail = np.array([chi2.sf(p, 2 * max(n, 1)) for p, n in zip(power, series, strict=True)])
    shape, place = np.unravel_index(np.argmin(tail), tail.shape)
    looks = tail.size
    p_value = -np.expm1(looks * np.log1p(-min(tail[shape, place], 1 - 1e-16)))
    evidence = float(np.logaddexp.reduce(gain, axis=None) - np.log(gain.size))
    joint = int(shape + 1) % (problem.setting.stiffness.size + 1)
    return Line(float(frequency[place]), joint, float(min(1.0, p_value)), evidence)


def list_shapes(stiffness: NDArray[np.float64]) -> NDArray[np.float64]:
    """List how far a wave moves the joints.

    (shape, joint): each alone, then all by a load.

    >>> list_shapes(np.array([1.0, 2.0]))
    array([[1. , 0. ],
           [0. , 1. ],
           [1. , 0.5]])
    """
    alone = np.eye(stiffness.size)
    return np.vstack([alone, 1.0 / stiffness]) if stiffness.size > 1 else alone


def measure_power(
    problem: Problem,
    residual: NDArray[np.float64],
    time: NDArray[np.float64],
    frequency: NDArray[np.float64],
    shapes: NDArray[np.float64],
) -> Iterator[tuple[int, NDArray[np.float64]]]:
    """Measure the power (frequency,) of waves of each shape in one trial; χ²₂ of noise alone.

    What neighbouring joints have in common, they get from the link between them: a wave in all
    joints stands out from their weighted sum (generalised least squares) and hardly from any one.
    """
    seen = np.isfinite(residual).sum(axis=1) >= DECISIONS.wave_frames
    used = np.isfinite(residual[seen]).all(axis=0)
    if not seen.any() or used.sum() < DECISIONS.wave_frames:
        return
    gap = np.diff(time[used]) / problem.trials.interval
    rho = problem.noise["noise_autocorrelation"].values[seen]
    pairs = zip(residual[seen][:, used], rho, strict=True)
    white = np.array([whiten_series(values, gap, r) for values, r in pairs])
    white -= white.mean(axis=1, keepdims=True)
    scale = white.std(axis=1)
    correlation = problem.noise["noise_correlation"].values[np.ix_(seen, seen)]
    for k, shape in enumerate(shapes):
        if not shape[~seen].any():
            weight = np.linalg.solve(correlation, shape[seen] / scale) / scale
            series = weight @ white  # its own variance is the measure: a model's may be wrong
            wave = transform_series(series, time[used], frequency)
            yield k, 2.0 * np.abs(wave) ** 2 / (series.size * series.var())


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
    values: NDArray[np.float64], gap: NDArray[np.float64], rho: float
) -> NDArray[np.float64]:
    """Whiten an AR(1) series seen with gaps.

    The gaps are in intervals over which its correlation is ρ.

    >>> whiten_series(np.array([1.0, 1.0]), np.array([1.0]), 0.6)
    array([1. , 0.5])
    """
    kept = rho**gap
    return np.append(values[:1], (values[1:] - kept * values[:-1]) / np.sqrt(1 - kept**2))
