"""Draws of the posterior, summed up for tables and figures."""

from __future__ import annotations

import arviz as az
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


def summarise_sampling(posterior: xr.Dataset) -> xr.Dataset:
    """Sum up convergence: r_hat, ess_bulk, ess_tail (quantity), and the worst quantity's draws.

    A quantity is one number of the posterior, such as `mu_log_k_v[1]`; one that never varies,
    because it was held fixed, is left out.
    """
    with np.errstate(invalid="ignore", divide="ignore"):  # a fixed quantity has no variance
        parts = {
            "r_hat": az.rhat(posterior),
            "ess_bulk": az.ess(posterior, method="bulk"),
            "ess_tail": az.ess(posterior, method="tail"),
        }
    table = {name: flatten_variables(part) for name, part in parts.items()}
    values = {name: np.array(list(row.values())) for name, row in table.items()}
    known = np.isfinite(values["r_hat"])
    names = np.array(list(table["r_hat"]))[known]
    worst = str(names[np.argmax(values["r_hat"][known])])
    draws = select_quantity(posterior, worst)
    return xr.Dataset(
        {name: ("quantity", row[known]) for name, row in values.items()}
        | {"worst_draws": (draws - draws.mean()) / draws.std()},
        coords={"quantity": names, "worst_quantity": worst},
    )


def flatten_variables(dataset: xr.Dataset) -> dict[str, float]:
    """Flatten variables to one number per name: `mu[1]`, `log_k_v[trial_001, 1]`."""
    flat = {}
    for name, array in dataset.data_vars.items():
        labels = [array[dim].values.astype(str) for dim in array.dims]
        for place in np.ndindex(array.shape):
            own = ", ".join(label[i] for label, i in zip(labels, place, strict=True))
            flat[f"{name}[{own}]" if own else str(name)] = float(array.values[place])
    return flat


def select_quantity(posterior: xr.Dataset, quantity: str) -> xr.DataArray:
    """Return the draws (chain, draw) of one quantity, named as `flatten_variables` does."""
    name = quantity.partition("[")[0]
    stacked = posterior[name].transpose("chain", "draw", ...)
    places = flatten_variables(xr.Dataset({name: stacked.isel(chain=0, draw=0, drop=True)}))
    flat = stacked.values.reshape(*stacked.shape[:2], -1)
    return xr.DataArray(flat[..., list(places).index(quantity)], dims=("chain", "draw"))
