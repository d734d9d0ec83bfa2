"""Draws in blocks, for campaigns of so many trials that the steps of NUTS become short.

A sweep draws, each given the rest:

- every trial's parameters, all trials side by side and each accepted on its own: its standard
  normals z under the whitening (`population.whitening`) become √(1 − β²) z + β ξ, ξ ~ N(0, 1),
  which keeps N(0, 1); what the trial's density has beyond it decides (Neal 1998). β is 1, a draw
  afresh, and then less, which moves trials that the data leave long tails;
- each population's log σ with μ integrated out, by slice sampling (Neal 2003), then μ, normal;
- the noise, number by number, by slice sampling: given the trials' parameters it needs nothing of
  the recordings but a few sums.

Where single trials tell their own parameters, sweeps are nearly independent. Where they do not, as
with a flow that is hardly seen, a population and its trials hold each other fast: R-hat shows it,
and NUTS is the better sampler. Only for independent parameters; the density is the one that
`estimation.model` declares, and a test holds the two samplers against each other.

References
----------
Neal (1998), doi:10.1007/978-94-011-5014-9_23 (section 4); Neal (2003), Ann. Statist. 31, 705,
doi:10.1214/aos/1056562461.
"""

from concurrent.futures import ThreadPoolExecutor
from functools import partial

import numpy as np
import xarray as xr
from numba import njit
from numpy.typing import NDArray
from scipy.special import expit, logit

from softfinger.population.correlation import shape_partials
from softfinger.population.covariance import factorise_partials, find_partials_array
from softfinger.population.likelihood import PARAMETERS, fill_trial_sums
from softfinger.population.pilot import Pilot, count_patterns
from softfinger.population.priors import Prior
from softfinger.population.weights import weigh_noise
from softfinger.population.whitening import colour_about, colour_trials, whiten_about
from softfinger.population.windows import LocalCollapse

DISPERSION = 2.0  # of the starts, in approximate posterior standard deviations
SHARES = (1.0, 0.4)  # β of the moves of a sweep
NOISE_ROUNDS = 2  # of slices a sweep: sd and autocorrelation go together


def sample_blocks(
    collapse: LocalCollapse,
    prior: Prior,
    pilot: Pilot,
    rng: np.random.Generator,
    *,
    chains: int,
    tune: int,
    draws: int,
    cores: int,
) -> tuple[dict[str, NDArray[np.float64]], xr.Dataset]:
    """Draw from the posterior of a campaign.

    Parameters
    ----------
    collapse, prior, pilot
        What `localise_collapse`, `build_prior` and `fit_pilot` make.
    rng
        Gives each chain its own stream.
    chains, tune, draws, cores
        As usual; the sweeps before `draws` are forgotten, nothing is adapted.

    Returns
    -------
    variables, statistics
        mu, sigma, noise_… and eta (chain, draw, …); acceptance_rate (chain, draw) of the trials'
        moves, diverging: nothing can.
    """
    trials, joints = collapse.window.shape
    eta = np.empty((chains, draws, trials, len(PARAMETERS) * joints))  # large: filled, not copied
    run = partial(_run_chain, collapse, prior, pilot, tune)
    with ThreadPoolExecutor(cores) as pool:
        found = list(pool.map(run, rng.spawn(chains), eta))
    drawn, accepted = zip(*found, strict=True)
    variables = {name: np.stack([chain[name] for chain in drawn]) for name in drawn[0]}
    variables["eta"] = eta
    rate = xr.DataArray(np.stack(accepted), dims=("chain", "draw"))
    diverging = xr.zeros_like(rate, dtype=bool)
    return variables, xr.Dataset({"diverging": diverging, "acceptance_rate": rate})


def _run_chain(
    collapse: LocalCollapse,
    prior: Prior,
    pilot: Pilot,
    tune: int,
    rng: np.random.Generator,
    kept: NDArray[np.float64],
) -> tuple[dict[str, NDArray], NDArray]:
    draws, trials, joints = len(kept), *collapse.window.shape
    size = len(PARAMETERS) * joints
    known = tuple(
        np.tile(part, joints)
        for part in (
            prior.mu_mean, prior.mu_sd, np.log(prior.sigma_median), prior.sigma_log_sd
        )
    )  # fmt: skip
    shape = shape_partials(joints) if joints > 1 else np.empty(0)
    noise_data = (
        collapse.gap, collapse.patterns, count_patterns(collapse),
        float(np.log(prior.noise_median)), float(prior.noise_log_sd), shape,
    )  # fmt: skip
    recordings = (collapse.windows, collapse.window, collapse.products, collapse.first)
    curvature = np.ascontiguousarray(np.moveaxis(pilot.modes.curvature, 0, -1))
    stand_in = (curvature, np.ascontiguousarray(pilot.modes.pull.T))
    point, width = _place_noise(pilot, float(collapse.count[:, :-1].sum()))
    point = point + DISPERSION * width * rng.standard_normal(point.size)
    few = DISPERSION / np.sqrt(2 * trials)
    sigma = pilot.sigma.ravel() * np.exp(few * rng.standard_normal(size))
    mu = pilot.mu.ravel() + DISPERSION * sigma / np.sqrt(trials) * rng.standard_normal(size)
    normal = rng.standard_normal((size, trials))
    eta = colour_trials(normal, *stand_in, mu, np.diag(1 / sigma**2))[0]
    sums = np.empty((trials, len(collapse.gap), 3, joints, joints))
    first_sums = np.empty((trials, joints, joints))
    by_trial = np.ascontiguousarray(eta.T).reshape(trials, joints, len(PARAMETERS))
    fill_trial_sums(by_trial, *recordings, sums, first_sums)
    drawn = {name: np.empty((draws, size)) for name in ("mu", "sigma")}
    noises, accepted = np.empty((draws, point.size)), np.empty(draws)
    for sweep in range(-tune, draws):
        sd, rho, partials = read_noise(point, joints)
        factor = factorise_partials(partials)
        weights = weigh_noise(collapse.gap, collapse.patterns, sd, rho, factor @ factor.T)
        weighing = (weights.pair, np.ascontiguousarray(weights.precision[:, -1]))
        count = 0
        for share in SHARES:
            count += move_trials(
                rng, share, eta, sums, first_sums, (mu, sigma), stand_in, weighing,
                collapse.pattern, recordings,
            )  # fmt: skip
        mu, sigma = draw_populations(rng, eta, sigma, known)
        totals = _sum_patterns(sums, collapse), _sum_patterns(first_sums, collapse)
        draw_noise(rng, point, 3 * width, *totals, noise_data)
        if sweep >= 0:
            drawn["mu"][sweep], drawn["sigma"][sweep], noises[sweep] = mu, sigma, point
            kept[sweep] = eta.T
            accepted[sweep] = count / (trials * len(SHARES))
    parts = np.split(noises, [joints, 2 * joints], axis=-1)
    drawn["noise_sd"], drawn["noise_autocorrelation"] = np.exp(parts[0]), expit(parts[1])
    drawn["noise_partial"] = np.tanh(parts[2])
    return drawn, accepted


def _place_noise(pilot: Pilot, frames: float) -> tuple[NDArray, NDArray]:
    """Find where the noise's numbers lie, and about how surely, as `draw_noise` reads them."""
    sd, rho, correlation = pilot.noise
    # nothing says that ρ is not 0 where it is within the sd that so many frames leave
    rho = np.clip(rho, 1 / np.sqrt(frames), 1 - 1e-6)
    partials = find_partials_array(correlation)
    point = np.concatenate([np.log(sd), logit(rho), np.arctanh(partials)])
    width = [
        np.sqrt((1 + rho**2) / (1 - rho**2) / (2 * frames)),
        np.sqrt((1 - rho**2) / frames) / (rho * (1 - rho)),
        np.full(len(partials), 1 / np.sqrt(frames)),
    ]
    return point, np.minimum(np.concatenate(width), 1.0)


def _sum_patterns(sums: NDArray, collapse: LocalCollapse) -> NDArray:
    """Sum over the trials of each pattern of present joints."""
    totals = [sums[collapse.pattern == k].sum(axis=0) for k in range(len(collapse.patterns))]
    return np.stack(totals)


@njit(cache=True, nogil=True, error_model="numpy")
def move_trials(
    rng: np.random.Generator,
    share: float,
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
    share
        β.
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
    after = np.sqrt(1 - share**2) * before + share * rng.standard_normal(eta.shape)
    moved = colour_about(after, centre, factor)
    new_sums, new_first = np.empty(sums.shape), np.empty(first_sums.shape)
    by_trial = np.ascontiguousarray(moved.T).reshape(trials, size // 4, 4)
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
        mean = eta[a].mean()
        square = ((eta[a] - mean) ** 2).sum()
        known = (mean - mu_mean[a], mu_sd[a], square, trials, log_sigma[a], sigma_log_sd[a])
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
        precision = trials / drawn[a] ** 2 + 1 / mu_sd[a] ** 2
        centre = (trials * mean / drawn[a] ** 2 + mu_mean[a] / mu_sd[a] ** 2) / precision
        mu[a] = centre + rng.standard_normal() / np.sqrt(precision)
    return mu, drawn


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
    point: NDArray,
    width: NDArray,
    sums: NDArray,
    first_sums: NDArray,
    noise: tuple,
) -> None:
    """Draw the noise's numbers in place, one after the other.

    Parameters
    ----------
    point, width
        log σ, logit ρ (joint,) and atanh of the partial correlations (pair,), one after the
        other, and about how wide a slice is.
    sums, first_sums
        Of `fill_trial_sums`, summed by pattern.
    noise
        As for `weigh_noise_point`.
    """
    for _ in range(NOISE_ROUNDS):
        for k in range(point.size):
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
