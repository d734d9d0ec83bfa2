"""Populations to propagate: two-stage estimate and posterior draws."""

from collections.abc import Sequence

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from softfinger.faults import Fault
from softfinger.mechanics import LOG_PARAMETERS, OWN, PARAMETERS

ESTIMATES = ("two_stage", "posterior")


def select_two_stage(least_squares: xr.Dataset) -> xr.Dataset:
    """Select the population of the paper's two-stage estimate.

    Parameters
    ----------
    least_squares
        The `least_squares` artifact: population_mean, population_sd (joint, parameter),
        residual_rms (trial, joint) [rad].

    Returns
    -------
    Dataset
        mu, sigma (draw, joint, parameter), of the logs except for q_ini [rad]; correlation
        (draw, own, other_own) of a finger's parameters, joint after joint: none; noise_sd
        (draw, joint) [rad], the median residual, as white noise; one draw.
    """
    chosen = least_squares.sel(parameter=list(PARAMETERS))
    population = xr.Dataset(
        {
            "mu": chosen["population_mean"].transpose("joint", "parameter"),
            "sigma": chosen["population_sd"].transpose("joint", "parameter"),
            "noise_sd": least_squares["residual_rms"].median("trial"),
        }
    )
    population = population.drop_vars(["trial"], errors="ignore").expand_dims(draw=1)
    for name in ("noise_autocorrelation", "noise_white"):
        population[name] = xr.zeros_like(population["noise_sd"])
    return _fill_correlations(population)


def select_posterior(posterior: xr.DataTree, draws: int) -> xr.Dataset:
    """Select populations from the posterior.

    Parameters
    ----------
    posterior
        The `posterior` artifact: mu_* and sigma_* (chain, draw, joint) of every population,
        noise_sd [rad], noise_autocorrelation, noise_white (chain, draw, joint) and, where fitted,
        parameter_correlation (…, own, other_own), noise_correlation (…, joint, other_joint).

    Returns
    -------
    Dataset
        As `select_two_stage`, with as many draws as asked for or there are; noise_autocorrelation,
        noise_white (draw, joint) and noise_correlation (draw, joint, other_joint) of innovations.

    Raises
    ------
    Fault
        If a hyperparameter is missing.
    """
    noise = ["noise_sd", "noise_autocorrelation", "noise_white"]
    wanted = [f"{kind}_{name}" for kind in ("mu", "sigma") for name in LOG_PARAMETERS] + noise
    fitted = [
        name
        for name in ("parameter_correlation", "noise_correlation")
        if name in posterior["posterior"]
    ]
    stacked = take_population_draws(posterior, [*wanted, *fitted], draws)
    parameter = xr.IndexVariable("parameter", list(PARAMETERS))
    population = xr.Dataset(
        {
            kind: xr.concat(
                [stacked[f"{kind}_{name}"] for name in LOG_PARAMETERS], parameter
            ).transpose("draw", "joint", "parameter")
            for kind in ("mu", "sigma")
        }
    )
    population = population.assign({name: stacked[name].transpose("draw", ...) for name in noise})
    for name in fitted:
        own = "correlation" if name == "parameter_correlation" else name
        population[own] = (
            stacked[name]
            .transpose("draw", ...)
            .drop_vars(("own", "other_own", "other_joint"), errors="ignore")
        )
    return _fill_correlations(population)


def are_independent(population: xr.Dataset) -> bool:
    """Whether a finger's parameters are independent in every draw."""
    correlation = population["correlation"].to_numpy()
    return bool((correlation == np.eye(correlation.shape[-1])).all())


def relate_own_array(
    correlation: NDArray[np.float64], sigma: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Fingers' covariance (…, 4 · joint, 4 · joint)."""
    sd = sigma.reshape(*sigma.shape[:-2], -1)
    return correlation * sd[..., :, None] * sd[..., None, :]


def select_own_blocks_array(correlation: NDArray[np.float64]) -> NDArray[np.float64]:
    """Select each joint's own correlations (draw, joint, 4, 4)."""
    starts = range(0, correlation.shape[-1], OWN)
    return np.stack([correlation[:, at : at + OWN, at : at + OWN] for at in starts], axis=1)


def take_population_draws(posterior: xr.DataTree, names: Sequence[str], draws: int) -> xr.Dataset:
    """Take some variables' draws, evenly.

    At most `draws` draws are taken.

    Raises
    ------
    Fault
        If the posterior lacks one of the variables.
    """
    group = posterior["posterior"].to_dataset()
    missing = [name for name in names if name not in group]
    if missing:
        raise Fault(
            f"the posterior has no {', '.join(missing)}: propagation needs every hyperparameter; "
            "fit the campaign again"
        )
    stacked = group[list(names)].stack(sample=("chain", "draw")).reset_index("sample", drop=True)
    chosen = choose_evenly(stacked.sizes["sample"], draws)
    return stacked.isel(sample=chosen).rename(sample="draw")


def choose_evenly(total: int, most: int) -> NDArray[np.int_]:
    """Choose at most `most` places, evenly.

    They are spread over `total` places.

    >>> choose_evenly(9, 3)
    array([0, 4, 8])
    """
    return np.rint(np.linspace(0, total - 1, min(most, total))).astype(int)


def _fill_correlations(population: xr.Dataset) -> xr.Dataset:
    """Add the correlations that were not fitted: none."""
    draws, joints = (population.sizes[name] for name in ("draw", "joint"))
    usual = {
        "correlation": (("draw", "own", "other_own"), joints * OWN),
        "noise_correlation": (("draw", "joint", "other_joint"), joints),
    }
    missing = {name: form for name, form in usual.items() if name not in population}
    return population.assign(
        {
            name: (dims, np.tile(np.eye(size), (draws, 1, 1)))
            for name, (dims, size) in missing.items()
        }
    )
