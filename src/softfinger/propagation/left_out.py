"""Predictions for a trial from the others.

Bands that a trial helped to make flatter it. For the two-stage estimate, new trials drawn from the
population N(μ, σ) weigh N(x; μ_−i, σ_−i)/N(x; μ, σ), with μ_−i, σ_−i from the other trials' kept
estimates. For the posterior, a draw weighs 1/p(η_i | μ, Ω), η_i being the trial's own parameters of
that joint in that draw: that takes the trial's recording out of the hyperparameters' posterior,
whatever the likelihood. The weights are neither cut nor smoothed, which would favour the trial
again.

ASSUME: given a trial's parameters of one joint, those of the others add nothing about that joint's
population.
"""

from collections.abc import Callable

import numpy as np
import xarray as xr
from numpy.typing import NDArray
from scipy.stats import norm

from softfinger.mechanics import LOG_PARAMETERS
from softfinger.propagation.moments import Q_INI
from softfinger.propagation.new_trials import NewTrials
from softfinger.propagation.populations import (
    relate_own_array,
    select_own_blocks_array,
    take_population_draws,
)

Weigh = Callable[[int, int, NewTrials], NDArray[np.float64]]
"""Place of the trial, place of the joint, samples → weights (n,) that sum to 1."""


def build_two_stage_weights(least_squares: xr.Dataset, trial: xr.DataArray) -> Weigh:
    """Build a trial's weights for the two-stage estimate.

    Parameters
    ----------
    least_squares
        estimate, kept (trial, joint, parameter).
    trial
        Names of the trials in the order in which they are asked for.
    """
    dims = ("trial", "joint", "parameter")
    estimate = least_squares["estimate"].reindex(trial=trial).transpose(*dims).to_numpy().copy()
    kept = least_squares["kept"].reindex(trial=trial, fill_value=False).transpose(*dims).to_numpy()
    estimate[~kept] = np.nan
    estimate[..., :Q_INI] = np.log(estimate[..., :Q_INI])

    def weigh(place: int, joint: int, samples: NewTrials) -> NDArray[np.float64]:
        own = estimate[place, joint]
        log_weight = np.zeros(len(samples.location))
        for parameter in np.flatnonzero(np.isfinite(own)):
            value = estimate[:, joint, parameter]
            others = value[np.isfinite(value) & (np.arange(value.size) != place)]
            if others.size < 2:
                return np.full(len(samples.location), np.nan)
            every = np.append(others, own[parameter])
            x = samples.location[:, parameter]
            log_weight += norm.logpdf(x, others.mean(), others.std(ddof=1))
            log_weight -= norm.logpdf(x, every.mean(), every.std(ddof=1))
        return normalise_weights_array(log_weight)

    return weigh


def build_posterior_weights(
    posterior: xr.DataTree, population: xr.Dataset, trial: xr.DataArray
) -> Weigh:
    """Build a trial's weights for the posterior.

    Parameters
    ----------
    posterior
        log_k_v, log_c_v, log_c_p, q_ini (chain, draw, trial, joint).
    population
        mu, sigma, correlation as `select_posterior` gives them, chosen among its draws.
    trial
        Names of the trials in the order in which they are asked for; one that the posterior does
        not know took no part in it.
    """
    own = take_population_draws(posterior, LOG_PARAMETERS, population.sizes["draw"]).to_dataarray(
        "parameter"
    )
    own = own.reindex(trial=trial).transpose("draw", "trial", "joint", "parameter")
    mu, sigma, correlation = (
        population[name].to_numpy() for name in ("mu", "sigma", "correlation")
    )
    covariance = relate_own_array(select_own_blocks_array(correlation), sigma[..., None, :])
    draws = zip(own.to_numpy(), mu, covariance, strict=True)
    log_density = np.stack([_compute_log_normal(x - centre, omega) for x, centre, omega in draws])

    def weigh(place: int, joint: int, samples: NewTrials) -> NDArray[np.float64]:
        return normalise_weights_array(-log_density[samples.draw, place, joint])

    return weigh


def _compute_log_normal(
    away: NDArray[np.float64], covariance: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Log of the normal density, up to a constant.

    It is (trial, joint).

    0 for a trial that is NaN.
    """
    root = np.linalg.cholesky(covariance)
    z = np.linalg.solve(root, np.moveaxis(away, 0, -1))  # (joint, p, trial)
    log_scale = np.log(np.diagonal(root, axis1=-2, axis2=-1)).sum(axis=-1)
    return np.nan_to_num(-0.5 * (z**2).sum(axis=-2) - log_scale[:, None]).T


def normalise_weights_array(log_weight: NDArray[np.float64]) -> NDArray[np.float64]:
    """Turn log weights into weights of sum 1.

    Both are (n,).

    >>> normalise_weights_array(np.log([1.0, 1.0, 2.0]) + 900.0)
    array([0.25, 0.25, 0.5 ])
    """
    weight = np.exp(log_weight - log_weight.max())
    return weight / weight.sum()
