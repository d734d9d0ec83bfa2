"""A wave in what a model leaves: one frequency at which every trial holds too much power.

A trial's residual, whitened as an AR(1) series, has power P ~ χ²₂ at every frequency. A wave of
normal amplitude, with a phase of its own in each trial, makes it (1 + g) χ²₂, so that a trial's
evidence is ½ P g / (1 + g) − log(1 + g) nats. It is summed over trials and averaged over sizes g,
frequencies and joints.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.stats import chi2

from softfinger.mismatch.problem import Problem

LEAST_PERIODS = 3  # in a trial: slower waves are drift
MOST_FREQUENCIES = 900
LEAST_FRAMES = 24
SIZES = (0.1, 0.3, 1.0, 3.0, 10.0, 100.0)


class Line(NamedTuple):
    """The strongest line: frequency [Hz], joint from 1, corrected p-value, evidence [nats]."""

    frequency_hz: float
    joint: int
    p_value: float
    gain: float


def find_line(problem: Problem, residual: NDArray[np.float64], time: NDArray[np.float64]) -> Line:
    """Find the strongest spectral line.

    Parameters
    ----------
    residual
        (trial, joint, frame) [rad], NaN where not used.
    time
        (trial, frame) [s].
    """
    interval, duration = problem.trials.interval, problem.setting.duration
    low, high = LEAST_PERIODS / duration, 0.45 / interval
    count = int(min(MOST_FREQUENCIES, max(2 * (high - low) * duration, 1)))
    frequency = np.linspace(low, high, count)
    rho = problem.noise["noise_autocorrelation"].values
    power = np.zeros((residual.shape[1], count))
    gain = np.zeros((len(SIZES), *power.shape))
    series = np.zeros(residual.shape[1], int)
    for i in range(len(residual)):
        for j in range(residual.shape[1]):
            used = np.isfinite(residual[i, j])
            if used.sum() < LEAST_FRAMES:
                continue
            white = whiten_series(residual[i, j, used], np.diff(time[i, used]) / interval, rho[j])
            wave = transform_series(white - white.mean(), time[i, used], frequency)
            here = 2.0 * np.abs(wave) ** 2 / (len(white) * white.var())
            power[j] += here
            for k, size in enumerate(SIZES):
                gain[k, j] += 0.5 * here * size / (1.0 + size) - np.log1p(size)
            series[j] += 1
    tail = np.array([chi2.sf(p, 2 * max(n, 1)) for p, n in zip(power, series, strict=True)])
    joint, place = np.unravel_index(np.argmin(tail), tail.shape)
    looks = tail.size
    p_value = -np.expm1(looks * np.log1p(-min(tail[joint, place], 1 - 1e-16)))
    evidence = float(np.logaddexp.reduce(gain, axis=None) - np.log(gain.size))
    return Line(float(frequency[place]), int(joint) + 1, float(min(1.0, p_value)), evidence)


def transform_series(
    values: NDArray[np.float64], time: NDArray[np.float64], frequency: NDArray[np.float64]
) -> NDArray[np.complex128]:
    """Fourier sums Σ v exp(−2πi f t) at evenly spaced frequencies, at uneven times.

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
    """Whiten an AR(1) series seen with gaps, in intervals over which its correlation is ρ.

    >>> whiten_series(np.array([1.0, 1.0]), np.array([1.0]), 0.6)
    array([1. , 0.5])
    """
    kept = rho**gap
    return np.append(values[:1], (values[1:] - kept * values[:-1]) / np.sqrt(1 - kept**2))
