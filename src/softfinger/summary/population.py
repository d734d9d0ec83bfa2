"""Population, effects and correlations of the posterior, as intervals."""

from collections.abc import Mapping

import numpy as np
import xarray as xr

from softfinger.summary.paper import build_paper_table

POPULATIONS = {"k_v": "log_k_v", "c_v": "log_c_v", "c_p": "log_c_p", "q_ini": "q_ini"}
STATISTICS = ("mu", "sigma")
UNSURE = 0.5
"""Relative sd above which a spread is hardly determined."""


def stack_population(posterior: xr.Dataset) -> xr.Dataset:
    """Gather draws of the population.

    mu, sigma (sample, joint, parameter).

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
    """List the quantiles of an interval.

    It is equal-tailed; its middle half and its median are included.

    >>> list_quantiles(0.9)
    [0.05, 0.25, 0.5, 0.75, 0.95]
    """
    tail = round((1 - ci_prob) / 2, 12)
    return [tail, 0.25, 0.5, 0.75, round(1 - tail, 12)]


def summarise_population(
    posterior: xr.Dataset, ci_prob: float, rivals: Mapping[str, xr.DataArray]
) -> xr.Dataset:
    """Summarise the population's parameters beside other estimates of them.

    Parameters
    ----------
    posterior
        mu_* and sigma_* (chain, draw, joint).
    rivals
        Name → values (statistic, joint, parameter) of another estimate.

    Returns
    -------
    Dataset
        quantile_value (quantile, statistic, parameter, joint), sd (statistic, parameter, joint),
        of the logarithm but for q_ini; centre, centre_sd (parameter, joint): the population's
        median on the parameter's own scale; centre_quantile with quantiles; unsure (parameter,
        joint), whether the spread is hardly determined; rival_value (rival, statistic, parameter,
        joint), and rival_centre (rival, parameter, joint) on the parameter's own scale.
    """
    population = stack_population(posterior)
    draws = population.to_dataarray("statistic")
    natural = take_natural(population["mu"])
    quantiles = list_quantiles(ci_prob)
    value, sd = draws.quantile(quantiles, "sample"), draws.std("sample", ddof=1)
    found = {
        "quantile_value": value,
        "sd": sd,
        "centre": natural.median("sample"),
        "centre_sd": natural.std("sample", ddof=1),
        "centre_quantile": natural.quantile(quantiles, "sample"),
        "unsure": (sd / value.sel(quantile=0.5)).sel(statistic="sigma", drop=True) > UNSURE,
    }
    if rivals:
        template = sd.isel(joint=slice(None))
        aligned = [table.reindex_like(template) for table in rivals.values()]
        rival = xr.concat(aligned, xr.IndexVariable("rival", list(rivals)), join="exact")
        found["rival_value"] = rival
        found["rival_centre"] = take_natural(rival.sel(statistic="mu", drop=True))
    order = ("rival", "quantile", "statistic", "parameter", "joint")
    return xr.Dataset(found).transpose(*order, missing_dims="ignore")


def take_natural(value: xr.DataArray) -> xr.DataArray:
    """Take values from log scale, except q_ini."""
    return xr.where(value["parameter"] == "q_ini", value, np.exp(value))


def gather_rivals(
    least_squares: xr.Dataset | None, *, like_the_paper: bool
) -> dict[str, xr.DataArray]:
    """Gather other populations (statistic, joint, parameter)."""
    rivals = {}
    if least_squares is not None:
        parts = [least_squares["population_mean"], least_squares["population_sd"]]
        statistic = xr.IndexVariable("statistic", list(STATISTICS))
        rivals["two_stage"] = xr.concat(parts, statistic, join="exact")
    if like_the_paper:
        rivals["paper"] = build_paper_table()
    return rivals


def summarise_effects(posterior: xr.Dataset, ci_prob: float) -> xr.Dataset:
    """Summarise the effects' parameters on their own scale.

    Returns
    -------
    Dataset
        effect_mean, effect_sd (effect_parameter) and effect_quantile (quantile, effect_parameter).
    """
    draws = posterior["effect"].stack(sample=("chain", "draw"))
    return xr.Dataset(
        {
            "effect_mean": draws.mean("sample"),
            "effect_sd": draws.std("sample", ddof=1),
            "effect_quantile": draws.quantile(list_quantiles(ci_prob), "sample"),
        }
    )


def summarise_correlations(posterior: xr.Dataset, ci_prob: float) -> xr.Dataset:
    """Summarise a trial's fitted correlations, the surest first.

    Returns
    -------
    Dataset
        one, other (pair): labels; correlation (pair, quantile): low, median, high; clear (pair),
        whether the interval excludes 0; by_chance (), how many would be clear by chance. Pairs
        that are fixed at one value are left out.
    """
    drawn = posterior["parameter_correlation"].stack(sample=("chain", "draw"))
    tails = [round((1 - ci_prob) / 2, 12), 0.5, round((1 + ci_prob) / 2, 12)]
    value = drawn.quantile(tails, "sample").transpose("own", "other_own", "quantile").values
    row, column = np.tril_indices(len(value), -1)
    low, middle, high = value[row, column].T
    free = high > low
    order = np.flatnonzero(free)
    order = order[np.argsort(-np.abs(middle[order]) / (high - low)[order], kind="stable")]
    labels = drawn["own"].values.astype(str)
    return xr.Dataset(
        {
            "one": ("pair", labels[column[order]]),
            "other": ("pair", labels[row[order]]),
            "correlation": (("pair", "quantile"), value[row, column][order]),
            "clear": ("pair", ((low > 0) | (high < 0))[order]),
            "by_chance": ((), (1 - ci_prob) * int(free.sum())),
        },
        coords={"quantile": tails},
    )
