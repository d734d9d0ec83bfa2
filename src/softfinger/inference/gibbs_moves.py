"""Compiled moves of a sweep (`gibbs`), lock free."""

import numpy as np
from numpy.typing import NDArray

from softfinger.compiled import compiled
from softfinger.inference.expansion import fill_squares
from softfinger.inference.whitening import colour_about, whiten_about


@compiled(error_model="numpy")
def step_trials(
    rng: np.random.Generator,
    kept: float,
    eta: NDArray,
    square: NDArray,
    population: tuple[NDArray, NDArray],
    place: tuple[NDArray, NDArray],
    effect: NDArray,
    scale: float,
    expansion: tuple[NDArray, NDArray, NDArray],
) -> int:
    """Move every trial's parameters in place.

    `eta` (d, trial) and its χ² are moved; returns the number of moves.

    Parameters
    ----------
    kept
        α.
    population
        μ and σ (d,).
    place
        Centre (d, trial) and factor (d, d, trial) of the whitening.
    effect, scale
        φ (p,) and s.
    expansion
        own, shared and gram of the expansion.
    """
    mean, sigma = population
    centre, factor = place
    before = whiten_about(eta, centre, factor)
    after = kept * before + np.sqrt(1 - kept**2) * rng.standard_normal(eta.shape)
    moved = colour_about(after, centre, factor)
    new = np.empty(square.shape)
    fill_squares(moved, effect, expansion[0], expansion[1], expansion[2], new)
    luck, accepted = rng.random(square.size), 0
    for i in range(square.size):
        gain = -0.5 * (new[i] - square[i]) / scale**2
        for a in range(eta.shape[0]):
            old, now = (eta[a, i] - mean[a]) / sigma[a], (moved[a, i] - mean[a]) / sigma[a]
            gain += 0.5 * (old**2 - now**2 + after[a, i] ** 2 - before[a, i] ** 2)
        if np.log(luck[i]) < gain:
            accepted += 1
            eta[:, i], square[i] = moved[:, i], new[i]
    return accepted


@compiled(error_model="numpy")
def draw_populations(
    rng: np.random.Generator,
    eta: NDArray,
    sigma: NDArray,
    prior: tuple[NDArray, NDArray, NDArray, NDArray],
) -> tuple[NDArray, NDArray]:
    """Draw μ and σ (p,) of the population.

    Given are the trials' parameters (p, trial); σ is drawn from its present value.
    """
    mu_mean, mu_sd, log_sigma, sigma_log_sd = prior
    size, trials = eta.shape
    mu, drawn = np.empty(size), np.empty(size)
    for a in range(size):
        mean, known = _sum_up(eta[a], (mu_mean[a], mu_sd[a], log_sigma[a], sigma_log_sd[a]))
        now, width = np.log(sigma[a]), 3 / np.sqrt(2.0 * trials)
        level = _weigh_log_sigma(now, known) + np.log(rng.random())
        low = now - width * rng.random()
        high = low + width
        while _weigh_log_sigma(low, known) > level:
            low -= width
        while _weigh_log_sigma(high, known) > level:
            high += width
        while True:
            point = low + (high - low) * rng.random()
            if _weigh_log_sigma(point, known) > level:
                break
            if point < now:
                low = point
            else:
                high = point
        drawn[a] = np.exp(point)
        centre, sd = _condition_mu(mean, trials, drawn[a], mu_mean[a], mu_sd[a])
        mu[a] = centre + sd * rng.standard_normal()
    return mu, drawn


@compiled(error_model="numpy")
def _sum_up(own: NDArray, prior: tuple[float, float, float, float]) -> tuple[float, tuple]:
    """Mean own parameter, and statistics for `_weigh_log_sigma`.

    The own parameters are (trial,).
    """
    mu_mean, mu_sd, log_sigma, sigma_log_sd = prior
    mean = own.mean()
    square = ((own - mean) ** 2).sum()
    return mean, (mean - mu_mean, mu_sd, square, own.size, log_sigma, sigma_log_sd)


@compiled(error_model="numpy")
def _condition_mu(
    mean: float, trials: int, sigma: float, mu_mean: float, mu_sd: float
) -> tuple[float, float]:
    """Mean and sd of μ given σ.

    The mean of the trials' parameters is given as well.
    """
    precision = trials / sigma**2 + 1 / mu_sd**2
    return (trials * mean / sigma**2 + mu_mean / mu_sd**2) / precision, 1 / np.sqrt(precision)


@compiled(error_model="numpy")
def _weigh_log_sigma(log_sigma: float, known: tuple) -> float:
    """Log density of log σ, μ integrated out."""
    away, mu_sd, square, trials, centre, spread = known
    variance = np.exp(2 * log_sigma)
    mean_variance = mu_sd**2 + variance / trials
    value = -(trials - 1) * log_sigma - 0.5 * square / variance
    value -= 0.5 * (np.log(mean_variance) + away**2 / mean_variance)
    return value - 0.5 * ((log_sigma - centre) / spread) ** 2
