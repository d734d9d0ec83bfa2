"""How both ways of fitting recover a known truth.

Two references, since a campaign of n trials is itself a draw: the population that the trials were
drawn from, which the intervals should contain, and the mean and sd of the true parameters of the
very trials, against which the luck of the draw cancels and what is left is the fit's own doing.

ASSUME: intervals of the two-stage way are the textbook's, which it invites but the paper does not
print: Student's t for μ, χ² for σ, normal with the least-squares sd for a trial's own parameter.
"""

from collections.abc import Iterable

import numpy as np
import pandas as pd
import xarray as xr
from numpy.typing import NDArray
from scipy.stats import chi2, norm, t

from softfinger.mechanics import LOG_PARAMETERS as SAMPLED

CI_PROBS = (0.5, 0.9)
NATURAL = ("k_v", "c_v", "c_p", "q_ini")
LEVELS = ("mu", "sigma")
POPULATION = ("statistic", "joint", "parameter")


def measure_recovery(
    truth: xr.Dataset, least_squares: xr.Dataset, posterior: xr.Dataset
) -> xr.Dataset:
    """Compare both estimates with a simulated truth.

    The estimates are the two-stage estimate and the posterior; the truth is that of a simulated
    campaign.

    Parameters
    ----------
    truth
        The `truth` artifact; trials that were set aside may be in it.
    posterior
        The group `posterior` of that artifact.

    Returns
    -------
    Dataset
        true_value (reference, statistic, joint, parameter): μ and σ, of the log but for q_ini;
        value, value_sd (estimate, statistic, joint, parameter); error_in_sd: (value − population's)
        / value_sd; relative_error (estimate, reference, statistic, joint, parameter): of μ on the
        parameter's own scale; inside (…, ci_prob): whether the interval contains the population's
        value; trial_coverage, trial_n (estimate, joint, parameter, …): share of the trials whose
        interval contains their own parameter, and of how many; trial_error (estimate, joint,
        parameter): median over them of |estimate / true − 1|. NaN where there was no estimate.
    """
    own = _align_truth(truth, posterior)
    two_stage = _judge_two_stage(least_squares.sel(trial=own["trial"], joint=own["joint"]), own)
    estimates = {"two_stage": two_stage, "posterior": _judge_posterior(posterior, own)}
    found = xr.concat([*estimates.values()], _label("estimate", estimates), join="exact")
    reference = xr.concat(
        [own["population"], _summarise_trials(own["trials"])],
        _label("reference", ("population", "trials")),
        coords="minimal",
    )
    known = reference.sel(reference="population", drop=True)
    inside = (found["low"] <= known) & (known <= found["high"])
    result = found.drop_vars(["low", "high"]).assign(
        true_value=reference,
        error_in_sd=(found["value"] - known) / found["value_sd"],
        relative_error=_compare(found["value"], reference),
        inside=inside.where(np.isfinite(found["low"])),
    )
    lead = ("estimate", "reference", *POPULATION, "ci_prob")
    return result.transpose(*lead).reset_coords(drop=True)


def tabulate_recovery(recovery: xr.Dataset) -> pd.DataFrame:
    """Tabulate a recovery by joint, parameter and estimate."""
    rows = []
    for joint in recovery["joint"].values:
        for parameter in recovery["parameter"].values:
            for estimate in recovery["estimate"].values:
                at = {"joint": joint, "parameter": parameter, "estimate": estimate}
                here = recovery.sel(at)
                row: dict[str, object] = dict(at)
                for level in LEVELS:
                    some = here.sel(statistic=level)
                    row[f"{level}_error_in_sd"] = float(some["error_in_sd"])
                    for name in recovery["reference"].values:
                        value = float(some["relative_error"].sel(reference=name))
                        row[f"{level}_relative_to_{name}"] = value
                    for share in recovery["ci_prob"].values:
                        holds = float(some["inside"].sel(ci_prob=share))
                        row[f"{level}_in_{share:.0%}"] = holds
                for share in recovery["ci_prob"].values:
                    covered = here["trial_coverage"].sel(ci_prob=share)
                    row[f"trials_in_{share:.0%}"] = float(covered)
                row["trials_missed_by"] = float(here["trial_error"])
                rows.append(row)
    return pd.DataFrame(rows)


def _align_truth(truth: xr.Dataset, posterior: xr.Dataset) -> xr.Dataset:
    """True populations and parameters of the fitted trials."""
    there = truth.sel(trial=posterior["trial"].values, joint=posterior["joint"].values)
    logs = {name: np.log(there[name]) for name in NATURAL[:3]} | {"q_ini": there["q_ini"]}
    parts = [there["population_mean"], there["population_sd"]]
    population = xr.concat(parts, _label("statistic", LEVELS)).sel(parameter=[*NATURAL])
    trials = xr.concat([*logs.values()], _label("parameter", NATURAL), coords="minimal")
    return xr.Dataset({"population": population, "trials": trials})


def _undo_log(values: xr.DataArray) -> xr.DataArray:
    log = values["parameter"] != "q_ini"
    return xr.where(log, np.exp(values.where(log, 0.0)), values)


def _summarise_trials(trials: xr.DataArray) -> xr.DataArray:
    parts = [trials.mean("trial"), trials.std("trial", ddof=1)]
    return xr.concat(parts, _label("statistic", LEVELS))


def _compare(value: xr.DataArray, reference: xr.DataArray) -> xr.DataArray:
    """Relative error of an estimate.

    For the μ of a log it is that of the median, exp(value − true) − 1.
    """
    ratio = value / reference - 1
    log = (value["statistic"] == "mu") & (value["parameter"] != "q_ini")
    return xr.where(log, np.expm1((value - reference).where(log, 0.0)), ratio)


def _judge_two_stage(least_squares: xr.Dataset, own: xr.Dataset) -> xr.Dataset:
    fitted = least_squares.sel(parameter=[*NATURAL])
    n = fitted["kept"].sum("trial").transpose("joint", "parameter").values
    mean, sd = (
        fitted[name].transpose("joint", "parameter").values
        for name in ("population_mean", "population_sd")
    )
    low, high = (_bound_moments(mean, sd, n, side) for side in (-1, 1))
    with np.errstate(divide="ignore", invalid="ignore"):
        errors = np.stack([sd / np.sqrt(n), sd / np.sqrt(2 * (n - 1))])
    estimate, true = fitted["estimate"].where(fitted["kept"]), _undo_log(own["trials"])
    distance = np.abs(estimate - true) / fitted["estimate_sd"]
    covered = [distance <= norm.ppf((1 + share) / 2) for share in CI_PROBS]
    return _gather(np.stack([mean, sd]), errors, (low, high), own).assign(
        _score_trials(covered, estimate.where(np.isfinite(distance)), true)
    )


def _bound_moments(
    mean: NDArray[np.float64], sd: NDArray[np.float64], n: NDArray[np.int64], side: int
) -> NDArray[np.float64]:
    """Bounds of a normal's moments.

    They are (statistic, joint, parameter, ci_prob), lower for −1 and upper for 1.

    >>> mean, sd, n = np.zeros((1, 1)), np.ones((1, 1)), np.full((1, 1), 5)
    >>> _bound_moments(mean, sd, n, 1)[:, 0, 0, 1].round(3)
    array([0.953, 2.372])
    """
    tail = 0.5 + side * np.array(CI_PROBS) / 2
    degrees = (n - 1.0)[..., None]
    with np.errstate(divide="ignore", invalid="ignore"):
        mu = mean[..., None] + t.ppf(tail, degrees) * (sd / np.sqrt(n))[..., None]
        sigma = sd[..., None] * np.sqrt(degrees / chi2.ppf(1 - tail, degrees))
    return np.stack([mu, sigma])


def _judge_posterior(posterior: xr.Dataset, own: xr.Dataset) -> xr.Dataset:
    draws = ("chain", "draw")
    levels = [
        np.stack([posterior[f"{level}_{name}"].transpose(*draws, "joint") for name in SAMPLED], -1)
        for level in LEVELS
    ]
    population = np.stack(levels, axis=2)
    trials = xr.concat([posterior[name] for name in SAMPLED], own["parameter"])
    covered = []
    for share in CI_PROBS:
        low, high = (
            trials.quantile(0.5 + side * share / 2, draws).drop_vars("quantile") for side in (-1, 1)
        )
        covered.append((low <= own["trials"]) & (own["trials"] <= high))
    bounds = [
        np.moveaxis(np.quantile(population, 0.5 + side * np.array(CI_PROBS) / 2, (0, 1)), 0, -1)
        for side in (-1, 1)
    ]
    value, sd = population.mean((0, 1)), population.std((0, 1))
    return _gather(value, sd, bounds, own).assign(
        _score_trials(covered, _undo_log(trials.mean(draws)), _undo_log(own["trials"]))
    )


def _gather(
    value: NDArray[np.float64],
    sd: NDArray[np.float64],
    bounds: tuple[NDArray[np.float64], NDArray[np.float64]] | list[NDArray[np.float64]],
    own: xr.Dataset,
) -> xr.Dataset:
    named = {"value": (POPULATION, value), "value_sd": (POPULATION, sd)}
    for name, bound in zip(("low", "high"), bounds, strict=True):
        named[name] = ((*POPULATION, "ci_prob"), bound)
    coords = {name: own[name].values for name in POPULATION}
    return xr.Dataset(named, {**coords, "ci_prob": [*CI_PROBS]})


def _score_trials(
    covered: list[xr.DataArray], estimate: xr.DataArray, true: xr.DataArray
) -> dict[str, xr.DataArray]:
    judged = np.isfinite(estimate)
    held = xr.concat(covered, _label("ci_prob", CI_PROBS)).where(judged)
    return {
        "trial_coverage": held.mean("trial"),
        "trial_n": judged.sum("trial"),
        "trial_error": np.abs(estimate / true - 1).median("trial"),
    }


def _label(name: str, values: Iterable[str | float]) -> xr.DataArray:
    return xr.DataArray(np.array([*values]), dims=name, name=name)
