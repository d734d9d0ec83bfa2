"""A quick approximate fit of the whole population, which tells a sampler where and how to look.

Expectation–maximisation with Laplace's approximation: modes and curvatures of the trials given
population and noise (`laplace`), then population given these, then noise given the residuals at the
modes. It starts from least squares and ends at the joint posterior's neighbourhood.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import minimize

from softfinger.population.collapse import Collapse
from softfinger.population.laplace import Modes, find_modes
from softfinger.population.likelihood import (
    compute_noise_weights_array,
    fill_quadratics,
    find_patterns_array,
)
from softfinger.population.priors import Prior
from softfinger.population.profile import build_joint_gram, profile_rates

ROUNDS = 12
NOISE_ROUNDS = (0, 1, 2, 4, 8)  # the noise settles early
LEAST_SHARE = 0.02  # of the median 1/k_v and 1/c_p: a start where least squares went negative


class Noise(NamedTuple):
    """Noise of the joints: σ (joint,) [rad], ρ (joint,), C (joint, joint) of the innovations."""

    sd: NDArray[np.float64]
    autocorrelation: NDArray[np.float64]
    correlation: NDArray[np.float64]


class Pilot(NamedTuple):
    """Where the posterior lies: population (joint, 4) twice, noise, and the trials' modes."""

    mu: NDArray[np.float64]
    sigma: NDArray[np.float64]
    noise: Noise
    modes: Modes


def fit_pilot(collapse: Collapse, prior: Prior) -> Pilot:
    """Fit population, noise and trials approximately.

    Parameters
    ----------
    collapse
        What `collapse_angles` makes.
    prior
        What `build_prior` makes.
    """
    eta, noise = _start(collapse, prior)
    trials, joints = collapse.present.shape
    patterns, _ = find_patterns_array(collapse.present)
    mu = np.median(eta, axis=0)
    sigma = np.tile(prior.sigma_median, (joints, 1))
    modes = None
    for turn in range(ROUNDS):
        weights = compute_noise_weights_array(collapse.gap, patterns, *noise)
        precision = np.diag(1 / sigma.ravel() ** 2)
        modes = find_modes(collapse, weights, mu.ravel(), precision, eta.reshape(trials, -1))
        eta = modes.eta.reshape(trials, joints, 4)
        covariance = np.linalg.inv(modes.curvature + precision)
        variance = np.einsum("tkk->tk", covariance).reshape(eta.shape)
        mu, sigma = update_population_array(eta, variance, sigma, prior)
        if turn in NOISE_ROUNDS:
            noise = fit_noise(collapse, eta, noise, prior)
    return Pilot(mu, sigma, noise, modes)


def update_population_array(
    eta: NDArray[np.float64],
    variance: NDArray[np.float64],
    sigma: NDArray[np.float64],
    prior: Prior,
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Raise the expected posterior over μ, σ (joint, 4) given modes and variances of trials.

    μ given the σ before; then σ at the root of n = S/σ² − (log σ − log m)/s² in log σ.
    """
    count = len(eta)
    information = count / sigma**2
    mu = (eta.sum(axis=0) / sigma**2 + prior.mu_mean / prior.mu_sd**2) / (
        information + 1 / prior.mu_sd**2
    )
    spread = ((eta - mu) ** 2 + variance).sum(axis=0)
    centre, width = np.log(prior.sigma_median), prior.sigma_log_sd**2
    log_sigma = np.log(sigma)
    for _ in range(30):
        pressure = spread * np.exp(-2 * log_sigma)
        slope = -count + pressure - (log_sigma - centre) / width
        log_sigma += np.clip(slope / (2 * pressure + 1 / width), -1.0, 1.0)
    return mu, np.exp(log_sigma)


def fit_noise(collapse: Collapse, eta: NDArray[np.float64], noise: Noise, prior: Prior) -> Noise:
    """Fit the noise to the residuals that the parameters eta (trial, joint, 4) leave."""
    patterns, index = find_patterns_array(collapse.present)
    joints = collapse.present.shape[1]
    sums, first_sums = _sum_residuals(collapse, eta, patterns, index)
    count = np.stack([collapse.count[index == p].sum(axis=0) for p in range(len(patterns))])
    started = np.bincount(index[collapse.present.any(axis=1)], minlength=len(patterns))

    def deviance(free: NDArray) -> float:
        trial = _unpack_noise(free, joints)
        weights = compute_noise_weights_array(collapse.gap, patterns, *trial)
        total = (weights.pair * sums).sum() + (weights.first * first_sums).sum()
        total += (count * weights.pair_logdet).sum() + (started * weights.first_logdet).sum()
        away = (np.log(trial.sd / prior.noise_median) / prior.noise_log_sd) ** 2
        return float(total + away.sum() + (free[joints:] ** 2).sum() * 0.01)

    start = np.concatenate([np.log(noise.sd), _logit(noise.autocorrelation)])
    start = np.concatenate([start, _flatten_correlation(noise.correlation)])
    found = minimize(deviance, start, method="L-BFGS-B", options={"maxiter": 60})
    return _unpack_noise(found.x, joints)


def _start(collapse: Collapse, prior: Prior) -> tuple[NDArray, Noise]:
    trials, joints = collapse.present.shape
    eta = np.tile(prior.mu_mean, (trials, joints, 1))
    sd = np.full(joints, prior.noise_median)
    frames = collapse.count.sum(axis=1) + 1
    for joint in range(joints):
        here = collapse.present[:, joint]
        if not here.any():
            continue
        profile = profile_rates(build_joint_gram(collapse, joint)[here], collapse.table)
        linear = profile.linear.copy()
        for k in (0, 1):
            positive = linear[linear[:, k] > 0, k]
            if len(positive):
                linear[:, k] = np.maximum(linear[:, k], LEAST_SHARE * np.median(positive))
        usable = (linear[:, :2] > 0).all(axis=1)
        log_k_v, log_c_p = -np.log(linear[usable, 0]), -np.log(linear[usable, 1])
        rows = np.flatnonzero(here)[usable]
        eta[rows, joint] = np.column_stack(
            [log_k_v, log_k_v - profile.log_rate[usable], log_c_p, linear[usable, 2]]
        )
        left = np.sqrt(np.maximum(profile.rss, 0) / frames[here])
        sd[joint] = max(float(np.median(left)), 1e-2 * prior.noise_median)
    return eta, Noise(sd, np.full(joints, 0.3), np.eye(joints))


def _sum_residuals(
    collapse: Collapse, eta: NDArray, patterns: NDArray, index: NDArray
) -> tuple[NDArray, NDArray]:
    trials, joints = collapse.present.shape
    shape = (len(patterns), len(collapse.gap), 3, joints, joints)
    sums, first_sums = np.zeros(shape), np.zeros((len(patterns), joints, joints))
    fill_quadratics(
        np.ascontiguousarray(eta), collapse.table.first, collapse.table.step,
        collapse.table.value, collapse.table.slope, collapse.products, collapse.first,
        np.zeros(shape), np.zeros_like(first_sums), index, np.empty(trials),
        np.empty((trials, joints, 4)), sums, first_sums,
    )  # fmt: skip
    return sums, first_sums


def _unpack_noise(free: NDArray, joints: int) -> Noise:
    sd, rho = np.exp(free[:joints]), 1 / (1 + np.exp(-free[joints : 2 * joints]))
    rows = np.eye(joints)
    rows[np.tril_indices(joints, -1)] = free[2 * joints :]
    rows /= np.linalg.norm(rows, axis=1, keepdims=True)
    return Noise(sd, rho, rows @ rows.T)


def _flatten_correlation(correlation: NDArray) -> NDArray:
    factor = np.linalg.cholesky(correlation)
    return (factor / np.diag(factor)[:, None])[np.tril_indices(len(factor), -1)]


def _logit(share: NDArray) -> NDArray:
    return np.log(share) - np.log1p(-share)
