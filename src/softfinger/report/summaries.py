"""Draws of the posterior, summed up for tables and figures."""

from __future__ import annotations

import numpy as np
import xarray as xr

POPULATIONS = {"k_v": "log_k_v", "c_v": "log_c_v", "c_p": "log_c_p", "q_ini": "q_ini"}
STATISTICS = ("mu", "sigma")


def stack_population(posterior: xr.Dataset) -> xr.Dataset:
    """Gather draws of the population: mu, sigma (sample, joint, parameter).

    Of the logarithm for k_v, c_v and c_p, natural for q_ini [rad].
    """
    parameter = xr.IndexVariable("parameter", list(POPULATIONS))
    gathered = {}
    for statistic in STATISTICS:
        parts = [posterior[f"{statistic}_{name}"] for name in POPULATIONS.values()]
        draws = xr.concat(parts, parameter, join="exact").stack(sample=("chain", "draw"))
        gathered[statistic] = draws.reset_index("sample", drop=True).transpose(
            "sample", "joint", "parameter"
        )
    return xr.Dataset(gathered)


def list_quantiles(ci_prob: float) -> list[float]:
    """List the quantiles of an equal-tailed interval, its middle half and its median.

    >>> list_quantiles(0.9)
    [0.05, 0.25, 0.5, 0.75, 0.95]
    """
    tail = round((1 - ci_prob) / 2, 12)
    return [tail, 0.25, 0.5, 0.75, round(1 - tail, 12)]


def summarise_hyperparameters(posterior: xr.Dataset, ci_prob: float) -> xr.Dataset:
    """Sum up the population's parameters.

    Returns
    -------
    Dataset
        quantile_value (quantile, statistic, parameter, joint), sd (statistic, parameter, joint),
        of the logarithm but for q_ini; centre, centre_sd (parameter, joint): the population's
        median on the parameter's own scale; centre_quantile with quantiles.
    """
    population = stack_population(posterior)
    draws = population.to_dataarray("statistic")
    natural = xr.where(draws["parameter"] == "q_ini", population["mu"], np.exp(population["mu"]))
    quantiles = list_quantiles(ci_prob)
    return xr.Dataset(
        {
            "quantile_value": draws.quantile(quantiles, "sample"),
            "sd": draws.std("sample", ddof=1),
            "centre": natural.median("sample"),
            "centre_sd": natural.std("sample", ddof=1),
            "centre_quantile": natural.quantile(quantiles, "sample"),
        }
    ).transpose("quantile", "statistic", "parameter", "joint")


def summarise_trial_parameters(posterior: xr.Dataset) -> xr.Dataset:
    """Return each trial's parameters (trial, joint): exp of the mean log, mean of q_ini."""
    mean = {name: posterior[name].mean(("chain", "draw")) for name in POPULATIONS.values()}
    own = {p: mean[n] if p == "q_ini" else np.exp(mean[n]) for p, n in POPULATIONS.items()}
    return xr.Dataset(own).transpose("trial", "joint")


def select_quantity(posterior: xr.Dataset, quantity: str) -> xr.DataArray:
    """Return the draws (chain, draw) of one quantity, named as the artifact `sampling` does.

    >>> draws = xr.DataArray(np.zeros((2, 5, 3)), {"joint": [1, 2, 3]}, ("chain", "draw", "joint"))
    >>> select_quantity(draws.to_dataset(name="mu_q_ini"), "mu_q_ini[2]").sizes["draw"]
    5
    """
    name, _, labels = quantity.rstrip("]").partition("[")
    draws = posterior[name].transpose("chain", "draw", ...)
    for dim, label in zip(draws.dims[2:], labels.split(", "), strict=True):
        draws = draws.isel({dim: draws[dim].values.astype(str).tolist().index(label)}, drop=True)
    return draws
