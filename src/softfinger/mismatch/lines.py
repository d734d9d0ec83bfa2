"""A spectral line in what a model leaves: one frequency at which every trial holds too much power.

A trial's residual, whitened as an AR(1) series, has power χ²₂ at every frequency; over trials the
powers add, whatever the phases. The largest of all frequencies and joints is tested with Šidák's
correction for the number of independent frequencies.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.stats import chi2

from softfinger.mismatch.problem import Problem

LEAST_PERIODS = 8  # in a trial: slower waves are drift
MOST_FREQUENCIES = 600


class Line(NamedTuple):
    """The strongest line: frequency [Hz], joint from 1, corrected p-value."""

    frequency_hz: float
    joint: int
    p_value: float


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
    count = int(min(MOST_FREQUENCIES, max((high - low) * duration, 1)))
    frequency = np.linspace(low, high, count)
    rho = problem.noise["noise_autocorrelation"].values
    power = np.zeros((residual.shape[1], count))
    series = np.zeros(residual.shape[1], int)
    for i in range(len(residual)):
        for j in range(residual.shape[1]):
            used = np.isfinite(residual[i, j])
            if used.sum() < 4 * LEAST_PERIODS:
                continue
            white = whiten_series(residual[i, j, used], np.diff(time[i, used]) / interval, rho[j])
            wave = np.exp(-2j * np.pi * np.outer(frequency, time[i, used]))
            power[j] += (
                2.0 * np.abs(wave @ (white - white.mean())) ** 2 / (len(white) * white.var())
            )
            series[j] += 1
    tail = np.array([chi2.sf(p, 2 * max(n, 1)) for p, n in zip(power, series, strict=True)])
    joint, place = np.unravel_index(np.argmin(tail), tail.shape)
    looks = tail.size
    p_value = -np.expm1(looks * np.log1p(-min(tail[joint, place], 1 - 1e-16)))
    return Line(float(frequency[place]), int(joint) + 1, float(min(1.0, p_value)))


def whiten_series(
    values: NDArray[np.float64], gap: NDArray[np.float64], rho: float
) -> NDArray[np.float64]:
    """Whiten an AR(1) series seen with gaps, in intervals over which its correlation is ρ.

    >>> whiten_series(np.array([1.0, 1.0]), np.array([1.0]), 0.6)
    array([1. , 0.5])
    """
    kept = rho**gap
    return np.append(values[:1], (values[1:] - kept * values[:-1]) / np.sqrt(1 - kept**2))
