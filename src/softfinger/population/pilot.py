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
from softfinger.population.covariance import (
    correlate_partials_array,
    factorise_partials,
    find_partials_array,
    pull_partials_back,
)
from softfinger.population.laplace import Modes, find_modes, stack_weights
from softfinger.population.priors import Prior
from softfinger.population.profile import GRID, build_joint_gram, profile_rates, solve_linear_array
from softfinger.population.weights import pull_weights_back, weigh_noise

ROUNDS = 12
NOISE_ROUNDS = (0, 1, 2, 4, 8)  # the noise settles early
LEAST_INFORMATION = 1e-6  # of the prior's
NEGLIGIBLE = 40.0  # nats
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
    value: NDArray[np.float64]  # (trial, p): what a trial by itself says of each parameter,
    variance: NDArray[np.float64]  # (trial, p): and how surely


def fit_pilot(collapse: Collapse, prior: Prior, near: Pilot | None = None) -> Pilot:
    """Fit population, noise and trials approximately.

    Parameters
    ----------
    collapse
        What `collapse_angles` makes.
    prior
        What `build_prior` makes.
    near
        A pilot fit of nearly the same frames, to start from.
    """
    trials, joints = collapse.present.shape
    if near is None:
        eta, noise = _start(collapse, prior)
        mu, sigma = np.median(eta, axis=0), np.tile(prior.sigma_median, (joints, 1))
    else:
        eta, noise, mu, sigma = near.modes.eta, near.noise, near.mu, near.sigma
    modes = None
    for turn in range(ROUNDS):
        weights = weigh_noise(collapse.gap, collapse.patterns, *noise)
        precision = np.diag(1 / sigma.ravel() ** 2)
        modes = find_modes(collapse, weights, mu.ravel(), precision, eta.reshape(trials, -1))
        eta = modes.eta.reshape(trials, joints, 4)
        covariance = np.linalg.inv(modes.curvature + precision)
        variance = np.einsum("tkk->tk", covariance).reshape(eta.shape)
        mu, sigma = update_population_array(eta, variance, sigma, prior)
        if turn in NOISE_ROUNDS:
            noise = fit_noise(collapse, eta, noise, prior)
    return Pilot(mu, sigma, noise, modes, *_read_trials(modes, prior))


def _read_trials(modes: Modes, prior: Prior) -> tuple[NDArray, NDArray]:
    """Value and variance (trial, p) of each parameter that a trial's stand-in gives by itself.

    Read off under a prior wide enough for any trial, which is then taken out again.
    """
    joints = modes.eta.shape[1] // 4
    width = np.tile(prior.mu_sd**2 + prior.sigma_median**2, joints)
    wide = np.diag(1 / width)
    covariance = np.linalg.inv(modes.curvature + wide)
    centre = np.tile(prior.mu_mean, joints) / width
    mean = np.einsum("tab,tb->ta", covariance, modes.pull + centre)
    spread = np.einsum("taa->ta", covariance)
    information = np.maximum(1 / spread - 1 / width, LEAST_INFORMATION / width)
    return (mean / spread - centre) / information, 1 / information


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
    joints = eta.shape[1]
    sums, first_sums = _sum_residuals(collapse, eta)
    total = count_patterns(collapse)

    def deviance(free: NDArray) -> tuple[float, NDArray]:
        log_sd, logit, angle = np.split(free, [joints, 2 * joints])
        sd, rho, partial = np.exp(log_sd), 1 / (1 + np.exp(-logit)), np.tanh(angle)
        factor = factorise_partials(partial)
        correlation = factor @ factor.T
        weights = weigh_noise(collapse.gap, collapse.patterns, sd, rho, correlation)
        value = (weights.pair * sums).sum() + (weights.precision[:, -1] * first_sums).sum()
        value += (total * weights.logdet).sum()
        sd_bar, rho_bar, correlation_bar = pull_weights_back(
            collapse.gap, sd, rho, correlation, weights.precision, sums, first_sums, total
        )
        partial_bar = pull_partials_back(partial, factor, correlation_bar)
        away = np.concatenate(
            [(log_sd - np.log(prior.noise_median)) / prior.noise_log_sd**2, 0.1 * free[joints:]]
        )
        slope = [sd_bar * sd, rho_bar * rho * (1 - rho), partial_bar * (1 - partial**2)]
        value += (away * np.concatenate([log_sd - np.log(prior.noise_median), free[joints:]])).sum()
        return value, np.concatenate(slope) + 2 * away

    start = [np.log(noise.sd), _logit(noise.autocorrelation)]
    start.append(np.arctanh(find_partials_array(noise.correlation)))
    found = minimize(deviance, np.concatenate(start), jac=True, method="L-BFGS-B")
    log_sd, logit, angle = np.split(found.x, [joints, 2 * joints])
    correlation = correlate_partials_array(np.tanh(angle))
    return Noise(np.exp(log_sd), 1 / (1 + np.exp(-logit)), correlation)


def count_patterns(collapse: Collapse) -> NDArray[np.float64]:
    """Count (pattern, gap + 1) the pairs of frames of each gap, then the trials."""
    total = np.zeros((len(collapse.patterns), collapse.count.shape[1]))
    np.add.at(total, collapse.pattern, collapse.count)
    return total


def _start(collapse: Collapse, prior: Prior) -> tuple[NDArray, Noise]:
    trials, joints = collapse.present.shape
    eta = np.tile(prior.mu_mean, (trials, joints, 1))
    sd = np.full(joints, prior.noise_median)
    frames = collapse.count.sum(axis=1)
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


def _sum_residuals(collapse: Collapse, eta: NDArray) -> tuple[NDArray, NDArray]:
    """Sum the residuals' products by pattern (pattern, gap, 3, J, J), and those of the first."""
    weight = stack_weights(eta, collapse.table, collapse.first.shape[1])
    each = weight[:, None, None] @ collapse.products @ weight.transpose(0, 2, 1)[:, None, None]
    first = np.einsum("ijr,ir->ij", weight, collapse.first)
    sums = np.zeros((len(collapse.patterns), *each.shape[1:]))
    first_sums = np.zeros((len(collapse.patterns), *each.shape[3:]))
    np.add.at(sums, collapse.pattern, each)
    np.add.at(first_sums, collapse.pattern, first[:, :, None] * first[:, None])
    return sums, first_sums


def _logit(share: NDArray) -> NDArray:
    return np.log(share) - np.log1p(-share)


def find_plausible_rates(
    collapse: Collapse, pilot: Pilot
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Find the range of x = log(k_v/c_v) outside of which a likelihood is not worth a thing.

    Returns
    -------
    low, high
        (trial, joint): inside lie the pilot's mode and all x at which the likelihood of that trial
        and joint, its other parameters at their best, is within `NEGLIGIBLE` nats of its largest.
    """
    grid = np.linspace(*collapse.table.nodes[[0, -1]], GRID)
    mode = pilot.modes.eta.reshape(*collapse.present.shape, 4)
    place = mode[..., 0] - mode[..., 1]
    low, high = place.copy(), place.copy()
    for joint, (sd, rho) in enumerate(
        zip(pilot.noise.sd, pilot.noise.autocorrelation, strict=True)
    ):
        gram = build_joint_gram(collapse, joint, sd, rho)
        rss = solve_linear_array(gram, np.tile(grid, (len(gram), 1)), collapse.table)[1]
        best = profile_rates(gram, collapse.table)
        plausible = rss <= best.rss[:, None] + 2 * NEGLIGIBLE
        lowest = np.where(plausible, grid, best.log_rate[:, None]).min(axis=1)
        highest = np.where(plausible, grid, best.log_rate[:, None]).max(axis=1)
        low[:, joint] = np.minimum(lowest, place[:, joint])
        high[:, joint] = np.maximum(highest, place[:, joint])
    margin = grid[1] - grid[0]
    # whole steps of the grid, so that trials share windows
    steps = [np.floor((low - grid[0]) / margin) - 1, np.ceil((high - grid[0]) / margin) + 1]
    here = collapse.present
    return tuple(grid[0] + margin * np.where(here, side, 0) for side in steps)
