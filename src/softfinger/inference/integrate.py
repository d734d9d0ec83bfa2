"""Likelihood of a trial, own parameters integrated out.

    p(y_i | μ, Ω, φ, s) = ∫ p(y_i | η, φ, s) N(η; μ, Ω) dη

by importance sampling from the normal that the likelihood's stand-in and the population make
(`whitening`). The normal follows the population from draw to draw, so few points suffice. They come
in pairs ±z; both the points and their weights are exact for a likelihood that is normal.
"""

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from softfinger.compiled import compiled
from softfinger.inference.budget import BUDGET
from softfinger.inference.correlation import invert_covariance_array
from softfinger.inference.expansion import Expansion, fill_squares
from softfinger.inference.whitening import colour_trials, shift_pull
from softfinger.mechanics import LOG_PARAMETERS


def compute_integrated_log_likelihood(
    expansion: Expansion, posterior: xr.Dataset, rng: np.random.Generator
) -> xr.DataArray:
    """Compute log p(y_i | population, effects, noise) [nats].

    Parameters
    ----------
    posterior
        mu_…, sigma_… (chain, draw, joint), effect_internal (chain, draw, effect_parameter),
        noise_scale (chain, draw) and, unless parameters are independent, parameter_correlation
        (chain, draw, own, other_own).

    Returns
    -------
    DataArray
        `recording` (chain, draw, trial).
    """
    lead = (posterior.sizes["chain"], posterior.sizes["draw"])
    mu, sigma = (
        np.stack([posterior[f"{level}_{name}"].values for name in LOG_PARAMETERS], axis=-1)
        for level in ("mu", "sigma")
    )
    effect, scale = (posterior[name].values for name in ("effect_internal", "noise_scale"))
    trials, size = expansion.own.shape
    half = rng.standard_normal((BUDGET.pairs, size, trials))
    points = np.concatenate([half, -half])
    correlation = posterior.get("parameter_correlation")
    result = np.empty((*lead, trials))
    for at in np.ndindex(*lead):
        precision = invert_covariance_array(
            sigma[at].ravel(), None if correlation is None else correlation.values[at]
        )
        population = mu[at].ravel(), precision
        result[at] = integrate_trials_array(expansion, *population, effect[at], scale[at], points)
    coords = {name: posterior[name] for name in ("chain", "draw", "trial")}
    return xr.DataArray(result, coords, ("chain", "draw", "trial"), name="recording")


def integrate_trials_array(
    expansion: Expansion,
    mean: NDArray[np.float64],
    precision: NDArray[np.float64],
    effect: NDArray[np.float64],
    scale: float,
    points: NDArray[np.float64],
) -> NDArray[np.float64]:
    """Integrate out the trials' parameters: (trial,) [nats].

    Parameters
    ----------
    mean, precision
        (d,) and (d, d) of the population.
    effect, scale
        (p,) φ, internal scale; s of the noise.
    points
        (m, d, trial) standard normal.
    """
    pull = shift_pull(expansion.pull, expansion.cross, effect - expansion.shared)
    curvature = expansion.curvature / scale**2
    log_weight = _weigh_points(
        points, curvature, pull / scale**2, mean, precision,
        effect, scale, expansion.own, expansion.shared, expansion.gram,
    )  # fmt: skip
    top = log_weight.max(axis=0)
    mean_weight = np.log(np.mean(np.exp(log_weight - top), axis=0)) + top
    constant = expansion.rows * np.log(2.0 * np.pi * scale**2) + expansion.logdet
    return mean_weight - 0.5 * constant


@compiled(error_model="numpy")
def _weigh_points(
    points: NDArray,
    curvature: NDArray,
    pull: NDArray,
    mean: NDArray,
    precision: NDArray,
    effect: NDArray,
    scale: float,
    own: NDArray,
    shared: NDArray,
    gram: NDArray,
) -> NDArray:
    """Log of p(y|η) p(η) / q(η): (point, trial)."""
    count, size, trials = points.shape
    half_log_det = np.log(np.diag(np.linalg.cholesky(precision))).sum()
    away = np.empty(size)
    log_weight = np.empty((count, trials))
    square = np.empty(trials)
    for m in range(count):
        eta, volume, _ = colour_trials(points[m], curvature, pull, mean, precision)
        fill_squares(eta, effect, own, shared, gram, square)
        for i in range(trials):
            total = volume[i] - 0.5 * square[i] / scale**2 + half_log_det
            for a in range(size):
                away[a] = eta[a, i] - mean[a]
                total += 0.5 * points[m, a, i] ** 2
                for b in range(a):
                    total -= away[a] * precision[a, b] * away[b]
                total -= 0.5 * precision[a, a] * away[a] ** 2
            log_weight[m, i] = total
    return log_weight
