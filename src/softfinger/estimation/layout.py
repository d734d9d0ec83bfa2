"""The fit laid out as ArviZ groups with the names that everything downstream reads."""

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from softfinger.estimation.assumptions import judge_independence, measure_prior_sensitivity
from softfinger.estimation.loo_pit import compute_loo_pit
from softfinger.estimation.predictive import draw_prior, predict_new_trials, predict_trials
from softfinger.population.covariance import correlate_partials_array
from softfinger.population.likelihood import PARAMETERS

if TYPE_CHECKING:
    from softfinger.estimation.posterior import Preparation

FEW_TRIALS = 5


def name_draws(
    variables: Mapping[str, NDArray[np.float64]], coords: Mapping[str, NDArray]
) -> xr.Dataset:
    """Name the model's variables (chain, draw, …) as the artifact does.

    Parameters
    ----------
    variables
        mu, sigma (…, 4 · joint), eta (…, trial, 4 · joint), noise_sd, noise_autocorrelation
        (…, joint), with several joints noise_partial (…, pair) and, unless parameters are
        independent, parameter_correlation (…, 4 · joint, 4 · joint); eta may be absent.
    coords
        trial and joint.
    """
    joints = len(coords["joint"])
    by_joint = {
        name: values.reshape(*values.shape[:-1], joints, len(PARAMETERS))
        for name, values in variables.items()
        if name in ("mu", "sigma", "eta")
    }
    dims = ("chain", "draw")
    named = {}
    for k, parameter in enumerate(PARAMETERS):
        for level in ("mu", "sigma"):
            named[f"{level}_{parameter}"] = ((*dims, "joint"), by_joint[level][..., k])
        if "eta" in by_joint:
            named[parameter] = ((*dims, "trial", "joint"), by_joint["eta"][..., k])
    for name in ("noise_sd", "noise_autocorrelation"):
        named[name] = ((*dims, "joint"), variables[name])
    correlation = correlate_partials_array(
        variables.get("noise_partial", np.empty((*variables["mu"].shape[:2], 0)))
    )
    named["noise_correlation"] = ((*dims, "joint", "other_joint"), correlation)
    if "parameter_correlation" in variables:
        own = [f"{name}[{joint}]" for joint in coords["joint"] for name in PARAMETERS]
        matrix = xr.Variable((*dims, "own", "other_own"), variables["parameter_correlation"])
        named["parameter_correlation"] = matrix
        labels = {"own": own, "other_own": own}
    else:
        labels = {}
    chains, draws = variables["mu"].shape[:2]
    labels |= {"chain": np.arange(chains), "draw": np.arange(draws), "joint": coords["joint"]}
    if "eta" in by_joint:
        labels["trial"] = coords["trial"]
    return xr.Dataset(named, {**labels, "other_joint": coords["joint"]})


def build_tree(
    angles: xr.Dataset,
    prepared: "Preparation",
    posterior: xr.Dataset,
    stats: xr.Dataset,
    scores: tuple[xr.DataArray, xr.Dataset, list[xr.Dataset]],
    config: Mapping[str, Any],
    rng: np.random.Generator,
) -> xr.DataTree:
    """Lay the fit out in ArviZ's groups, with predictions and the trials' scores."""
    frames, collapse, prior_constants, _, coords = prepared
    drawn = draw_prior(prior_constants, len(coords["joint"]), rng, config["covariance"])
    prior = name_draws(drawn, coords)
    draws = config["predictive_draws"]
    observed = angles[["joint_angle", "time"]].transpose("trial", "joint", "frame")
    groups = {
        "posterior": posterior,
        "sample_stats": stats,
        "prior": prior,
        "prior_predictive": predict_new_trials(angles, frames, prior, draws, rng),
        "posterior_predictive": predict_trials(angles, frames, posterior, draws, rng).merge(
            predict_new_trials(angles, frames, posterior, draws, rng)
        ),
        "log_likelihood": scores[0].to_dataset(name="recording"),
        "leave_one_out": scores[1],
        "loo_pit": compute_loo_pit(angles, frames, scores[2], *rng.spawn(1)),
        "prior_sensitivity": measure_prior_sensitivity(posterior, scores[0], prior_constants),
        "observed_data": observed.reset_coords(drop=True),
        "constant_data": _describe_constants(angles, frames, prior_constants),
    }
    if "parameter_correlation" not in posterior:  # asks what the fit took for granted
        groups["independence"] = judge_independence(posterior)
    tree = xr.DataTree.from_dict({f"/{name}": group for name, group in groups.items()})
    tree.attrs["note"] = describe_limits(collapse.present)
    return tree


def describe_limits(present: NDArray[np.bool_]) -> str:
    """Say in a sentence what so few trials cannot tell; empty where there are enough.

    >>> describe_limits(np.ones((2, 3), bool))
    '2 trials hardly tell how parameters spread over trials: sigma is mostly its prior.'
    """
    trials = int(present.any(axis=1).sum())
    if trials == 1:
        return "One trial is no population: sigma is its prior, and mu is known no better than it."
    if trials < FEW_TRIALS:
        return (
            f"{trials} trials hardly tell how parameters spread over trials: "
            "sigma is mostly its prior."
        )
    return ""


def _describe_constants(angles: xr.Dataset, frames: xr.Dataset, prior: tuple) -> xr.Dataset:
    constants = angles[["load_time", "load_torque"]].reset_coords(drop=True)
    constants = constants.assign(
        {name: frames[name].variable for name in ("present", "used", "outlier", "frame_scale")}
    )
    for name in ("mu_mean", "mu_sd", "sigma_median", "sigma_log_sd"):
        constants[f"prior_{name}"] = ("parameter", getattr(prior, name))
    for name in ("noise_median", "noise_log_sd"):
        constants[f"prior_{name}"] = ((), getattr(prior, name))
    constants["frame_interval"] = frames["frame_interval"].variable
    return constants.assign_coords(parameter=list(PARAMETERS))
