"""The likelihood of a trial with its own parameters integrated over the population.

    p(y_i | μ, Ω, noise) = ∫ p(y_i | η, noise) N(η; μ, Ω) dη

by importance sampling from the normal that the likelihood's stand-in and the population make
(`whitening`). The normal follows the population from draw to draw, so few points suffice; they come
in pairs ±z, and both the points and their weights are exact for a likelihood that is normal.
"""

import numpy as np
import xarray as xr
from numba import njit
from numpy.typing import NDArray

from softfinger.population.correlation import invert_covariance_array
from softfinger.population.laplace import Modes
from softfinger.population.likelihood import PARAMETERS, fill_squares
from softfinger.population.weights import weigh_noise
from softfinger.population.whitening import colour_trials
from softfinger.population.windows import LocalCollapse, Windows

PAIRS = 4


def compute_integrated_log_likelihood(
    collapse: LocalCollapse, modes: Modes, posterior: xr.Dataset, rng: np.random.Generator
) -> xr.DataArray:
    """Compute log p(y_i | population, noise) [nats] for every draw and trial.

    Parameters
    ----------
    collapse, modes
        Of the campaign.
    posterior
        mu_…, sigma_… (chain, draw, joint) of the four parameters, noise_sd, noise_autocorrelation
        (chain, draw, joint), noise_correlation (chain, draw, joint, other_joint) and, unless
        parameters are independent, parameter_correlation (chain, draw, own, other_own).
    rng
        For the points.

    Returns
    -------
    DataArray
        `recording` (chain, draw, trial).
    """
    lead = (posterior.sizes["chain"], posterior.sizes["draw"])
    mu, sigma = (
        np.stack([posterior[f"{level}_{name}"].values for name in PARAMETERS], axis=-1)
        for level in ("mu", "sigma")
    )
    trials, size = modes.eta.shape
    half = rng.standard_normal((PAIRS, size, trials))
    points = np.concatenate([half, -half])
    stand_in = (np.moveaxis(modes.curvature, 0, -1).copy(), modes.pull.T.copy())
    correlation = posterior.get("parameter_correlation")
    correlation = None if correlation is None else correlation.values
    result = np.empty((*lead, trials))
    for at in np.ndindex(*lead):
        noise = [posterior[f"noise_{name}"].values[at] for name in _NOISE]
        precision = invert_covariance_array(
            sigma[at].ravel(), None if correlation is None else correlation[at]
        )
        population = (mu[at].ravel(), precision)
        result[at] = integrate_trials_array(collapse, stand_in, *population, *noise, points)
    coords = {name: posterior[name] for name in ("chain", "draw", "trial")}
    return xr.DataArray(result, coords, ("chain", "draw", "trial"), name="recording")


_NOISE = ("sd", "autocorrelation", "correlation")


def integrate_trials_array(
    collapse: LocalCollapse,
    stand_in: tuple[NDArray[np.float64], NDArray[np.float64]],
    mean: NDArray[np.float64],
    precision: NDArray[np.float64],
    noise_sd: NDArray[np.float64],
    autocorrelation: NDArray[np.float64],
    correlation: NDArray[np.float64],
    points: NDArray[np.float64],
) -> NDArray[np.float64]:
    """Integrate out the trials' parameters: (trial,) [nats], for one population and noise.

    Parameters
    ----------
    collapse
        Of the campaign.
    stand_in
        Curvature (p, p, trial) and pull (p, trial) of the likelihood's normal stand-in.
    mean, precision
        (p,) and (p, p) of the population.
    noise_sd, autocorrelation, correlation
        Of the noise.
    points
        (m, p, trial) standard normal.
    """
    weights = weigh_noise(collapse.gap, collapse.patterns, noise_sd, autocorrelation, correlation)
    log_weight = _weigh_points(
        points, *stand_in, mean, precision, collapse.windows, collapse.window, collapse.products,
        collapse.first, weights.pair, weights.precision[:, -1].copy(), collapse.pattern,
        len(noise_sd),
    )  # fmt: skip
    logdet = (collapse.count * weights.logdet[collapse.pattern]).sum(axis=1)
    top = log_weight.max(axis=0)
    mean_weight = np.log(np.mean(np.exp(log_weight - top), axis=0)) + top
    return np.where(collapse.present.any(axis=1), mean_weight, 0.0) + collapse.offset - 0.5 * logdet


@njit(cache=True, error_model="numpy")
def _weigh_points(
    points: NDArray,
    curvature: NDArray,
    pull: NDArray,
    mean: NDArray,
    precision: NDArray,
    windows: Windows,
    window: NDArray,
    products: NDArray,
    first: NDArray,
    pair: NDArray,
    initial: NDArray,
    pattern: NDArray,
    joints: int,
) -> NDArray:
    """Log of p(y|η) p(η) / q(η), but for noise constants: (point, trial)."""
    count, size, trials = points.shape
    half_log_det = np.log(np.diag(np.linalg.cholesky(precision))).sum()
    away = np.empty(size)
    log_weight = np.empty((count, trials))
    quadratic = np.empty(trials)
    for m in range(count):
        eta, volume, _ = colour_trials(points[m], curvature, pull, mean, precision)
        own = eta.T.copy().reshape((trials, joints, 4))
        fill_squares(
            own, windows, window, products, first, pair, initial, pattern, quadratic,
        )  # fmt: skip
        for i in range(trials):
            total = volume[i] - 0.5 * quadratic[i] + half_log_det
            for a in range(size):
                away[a] = eta[a, i] - mean[a]
                total += 0.5 * points[m, a, i] ** 2
                for b in range(a):
                    total -= away[a] * precision[a, b] * away[b]
                total -= 0.5 * precision[a, a] * away[a] ** 2
            log_weight[m, i] = total
    return log_weight
