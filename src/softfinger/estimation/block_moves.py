"""The moves of a sweep (`blocks`), compiled; they let other threads run."""

import numpy as np
from numba import njit
from numpy.typing import NDArray

from softfinger.population.covariance import factorise_partials
from softfinger.population.likelihood import PARAMETERS, fill_trial_sums
from softfinger.population.weights import weigh_noise
from softfinger.population.whitening import colour_about, colour_trials, whiten_about

OWN = len(PARAMETERS)


@njit(cache=True, nogil=True, error_model="numpy")
def move_trials(
    rng: np.random.Generator,
    kept: float,
    eta: NDArray,
    sums: NDArray,
    first_sums: NDArray,
    population: tuple[NDArray, NDArray],
    stand_in: tuple[NDArray, NDArray],
    weights: tuple[NDArray, NDArray],
    pattern: NDArray,
    recordings: tuple,
) -> int:
    """Move every trial's parameters `eta` (p, trial) and its sums in place; count the moves.

    Parameters
    ----------
    kept
        α.
    population
        μ and σ (p,).
    stand_in
        The likelihood's: curvature (p, p, trial), pull (p, trial).
    weights
        Of `weigh_noise`: of pairs of frames, and of the first frame.
    recordings
        Of `fill_trial_sums`: windows, window, products, first row.
    """
    mean, sigma = population
    size, trials = eta.shape
    centre, _, factor = colour_trials(
        np.zeros(eta.shape), stand_in[0], stand_in[1], mean, np.diag(1 / sigma**2)
    )
    before = whiten_about(eta, centre, factor)
    after = kept * before + np.sqrt(1 - kept**2) * rng.standard_normal(eta.shape)
    moved = colour_about(after, centre, factor)
    new_sums, new_first = np.empty(sums.shape), np.empty(first_sums.shape)
    by_trial = np.ascontiguousarray(moved.T).reshape(trials, size // OWN, OWN)
    windows, window, products, first = recordings
    fill_trial_sums(by_trial, windows, window, products, first, new_sums, new_first)
    luck, accepted = rng.random(trials), 0
    for i in range(trials):
        pair, initial = weights[0][pattern[i]], weights[1][pattern[i]]
        gain = -0.5 * (
            ((new_sums[i] - sums[i]) * pair).sum()
            + ((new_first[i] - first_sums[i]) * initial).sum()
        )
        for a in range(size):
            old, new = (eta[a, i] - mean[a]) / sigma[a], (moved[a, i] - mean[a]) / sigma[a]
            gain += 0.5 * (old**2 - new**2 + after[a, i] ** 2 - before[a, i] ** 2)
        if np.log(luck[i]) < gain:
            accepted += 1
            eta[:, i], sums[i], first_sums[i] = moved[:, i], new_sums[i], new_first[i]
    return accepted


@njit(cache=True, nogil=True, error_model="numpy")
def draw_populations(
    rng: np.random.Generator,
    eta: NDArray,
    sigma: NDArray,
    prior: tuple[NDArray, NDArray, NDArray, NDArray],
) -> tuple[NDArray, NDArray]:
    """Draw μ and σ (p,) given the trials' parameters (p, trial); from σ as it was."""
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


@njit(cache=True, nogil=True, error_model="numpy")
def mirror_populations(
    rng: np.random.Generator,
    eta: NDArray,
    mu: NDArray,
    sigma: NDArray,
    prior: tuple[NDArray, NDArray, NDArray, NDArray],
) -> tuple[NDArray, NDArray]:
    """Mirror log σ about the middle that the trials' parameters give it, then μ about its mean.

    μ, standardised, is independent of σ given the trials' parameters: so each is mirrored alone.
    """
    mu_mean, mu_sd, log_sigma, sigma_log_sd = prior
    size, trials = eta.shape
    mirrored, drawn = np.empty(size), np.empty(size)
    for a in range(size):
        mean, known = _sum_up(eta[a], (mu_mean[a], mu_sd[a], log_sigma[a], sigma_log_sd[a]))
        weight, prior_weight = 2.0 * (trials - 1), sigma_log_sd[a] ** -2.0
        middle = prior_weight * log_sigma[a]
        if trials > 1:
            middle += weight * 0.5 * np.log(known[2] / (trials - 1))
        middle /= weight + prior_weight
        now = np.log(sigma[a])
        there = 2.0 * middle - now
        gain = _weigh_log_sigma(there, known) - _weigh_log_sigma(now, known)
        drawn[a] = np.exp(there) if np.log(rng.random()) < gain else sigma[a]
        before, sd_before = _condition_mu(mean, trials, sigma[a], mu_mean[a], mu_sd[a])
        after, sd_after = _condition_mu(mean, trials, drawn[a], mu_mean[a], mu_sd[a])
        mirrored[a] = after - sd_after / sd_before * (mu[a] - before)
    return mirrored, drawn


@njit(cache=True, error_model="numpy")
def _sum_up(own: NDArray, prior: tuple[float, float, float, float]) -> tuple[float, tuple]:
    """Mean of the trials' own parameter (trial,), and what `_weigh_log_sigma` knows of them."""
    mu_mean, mu_sd, log_sigma, sigma_log_sd = prior
    mean = own.mean()
    square = ((own - mean) ** 2).sum()
    return mean, (mean - mu_mean, mu_sd, square, own.size, log_sigma, sigma_log_sd)


@njit(cache=True, error_model="numpy")
def _condition_mu(
    mean: float, trials: int, sigma: float, mu_mean: float, mu_sd: float
) -> tuple[float, float]:
    """Mean and sd of μ given the mean of the trials' parameters and σ."""
    precision = trials / sigma**2 + 1 / mu_sd**2
    return (trials * mean / sigma**2 + mu_mean / mu_sd**2) / precision, 1 / np.sqrt(precision)


@njit(cache=True, error_model="numpy")
def _weigh_log_sigma(log_sigma: float, known: tuple) -> float:
    """Log density of log σ, μ integrated out."""
    away, mu_sd, square, trials, centre, spread = known
    variance = np.exp(2 * log_sigma)
    mean_variance = mu_sd**2 + variance / trials
    value = -(trials - 1) * log_sigma - 0.5 * square / variance
    value -= 0.5 * (np.log(mean_variance) + away**2 / mean_variance)
    return value - 0.5 * ((log_sigma - centre) / spread) ** 2


@njit(cache=True, nogil=True, error_model="numpy")
def draw_noise(
    rng: np.random.Generator,
    numbers: NDArray,
    point: NDArray,
    width: NDArray,
    sums: NDArray,
    first_sums: NDArray,
    noise: tuple,
) -> None:
    """Draw the noise's numbers in place, one after the other.

    Parameters
    ----------
    numbers
        Places of those that are drawn, in their order.
    point, width
        log σ, logit ρ (joint,) and atanh of the partial correlations (pair,), one after the
        other, and about how wide a slice is.
    sums, first_sums
        Of `fill_trial_sums`, summed by pattern.
    noise
        As for `weigh_noise_point`.
    """
    for k in numbers:
        now = point[k]
        level = weigh_noise_point(point, sums, first_sums, noise) + np.log(rng.random())
        low = now - width[k] * rng.random()
        high = low + width[k]
        point[k] = low
        while weigh_noise_point(point, sums, first_sums, noise) > level:
            point[k] -= width[k]
        low, point[k] = point[k], high
        while weigh_noise_point(point, sums, first_sums, noise) > level:
            point[k] += width[k]
        high = point[k]
        while True:
            point[k] = low + (high - low) * rng.random()
            if weigh_noise_point(point, sums, first_sums, noise) > level:
                break
            if point[k] < now:
                low = point[k]
            else:
                high = point[k]


@njit(cache=True, nogil=True, error_model="numpy")
def mirror_noise(
    rng: np.random.Generator,
    numbers: NDArray,
    point: NDArray,
    middle: NDArray,
    sums: NDArray,
    first_sums: NDArray,
    noise: tuple,
) -> None:
    """Mirror these of the noise's numbers in place, each about a middle that never changes."""
    level = weigh_noise_point(point, sums, first_sums, noise)
    for k in numbers:
        now = point[k]
        point[k] = 2.0 * middle[k] - now
        there = weigh_noise_point(point, sums, first_sums, noise)
        if np.log(rng.random()) < there - level:
            level = there
        else:
            point[k] = now


@njit(cache=True, error_model="numpy")
def read_noise(point: NDArray, joints: int) -> tuple[NDArray, NDArray, NDArray]:
    """Read σ, ρ (joint,) and the partial correlations (pair,) from a point."""
    sd = np.exp(point[:joints])
    rho = 1 / (1 + np.exp(-point[joints : 2 * joints]))
    return sd, rho, np.tanh(point[2 * joints :])


@njit(cache=True, error_model="numpy")
def weigh_noise_point(point: NDArray, sums: NDArray, first_sums: NDArray, noise: tuple) -> float:
    """Log density of the noise's numbers given the trials' sums, but for a constant.

    `noise` holds gap, patterns, total (`count_patterns`), the prior's log median and log sd, and
    the shapes of the partial correlations.
    """
    gap, patterns, total, log_median, log_sd, shape = noise
    joints = patterns.shape[1]
    sd, rho, partial = read_noise(point, joints)
    if not (rho < 1.0).all() or not (np.abs(partial) < 1.0).all():
        return -np.inf
    factor = factorise_partials(partial)
    weights = weigh_noise(gap, patterns, sd, rho, factor @ factor.T)
    value = -0.5 * (total * weights.logdet).sum() - 0.5 * (sums * weights.pair).sum()
    value -= 0.5 * (first_sums * weights.precision[:, -1]).sum()
    value -= 0.5 * (((point[:joints] - log_median) / log_sd) ** 2).sum()
    value += (np.log(rho) + np.log(1.0 - rho)).sum()  # uniform ρ
    value += (shape * np.log(1.0 - partial**2)).sum()  # beta on (−1, 1), and the volume of atanh
    return value if np.isfinite(value) else -np.inf
