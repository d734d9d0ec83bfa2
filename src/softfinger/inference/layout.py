"""The fit laid out as ArviZ groups."""

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from softfinger.inference.assumptions import judge_independence, measure_prior_sensitivity
from softfinger.inference.correction import Correction
from softfinger.inference.decisions import DECISIONS
from softfinger.inference.loo_pit import compute_loo_pit
from softfinger.inference.predictive import (
    Recorded,
    draw_prior,
    predict_new_trials,
    predict_trials,
)
from softfinger.inference.problem import Problem
from softfinger.inference.setting_table import tabulate_setting
from softfinger.measurement.words import describe_components
from softfinger.mechanics import LOG_PARAMETERS

if TYPE_CHECKING:
    from softfinger.inference.posterior import Preparation


def name_draws(
    variables: Mapping[str, NDArray[np.float64]],
    coords: Mapping[str, NDArray],
    recorded: Recorded,
) -> xr.Dataset:
    """Name the model's variables as the artifact does.

    They have the dimensions (chain, draw, …).

    Parameters
    ----------
    variables
        mu, sigma (…, 4 · joint), eta (…, trial, 4 · joint), effect (…, effect_parameter) on the
        internal scale, noise_scale (…) and, unless parameters are independent,
        parameter_correlation (…, 4 · joint, 4 · joint); eta may be absent.
    coords
        trial, joint and effect_parameter.
    recorded
        Gives the noise that was estimated, and the scales of the effects.
    """
    joints, dims = len(coords["joint"]), ("chain", "draw")
    by_joint = {
        name: values.reshape(*values.shape[:-1], joints, len(LOG_PARAMETERS))
        for name, values in variables.items()
        if name in ("mu", "sigma", "eta")
    }
    labels = {name: coords[name] for name in ("joint", "effect_parameter")}
    named = {}
    for k, parameter in enumerate(LOG_PARAMETERS):
        for level in ("mu", "sigma"):
            named[f"{level}_{parameter}"] = ((*dims, "joint"), by_joint[level][..., k])
        if "eta" in by_joint:
            named[parameter] = ((*dims, "trial", "joint"), by_joint["eta"][..., k])
            labels["trial"] = coords["trial"]
    named |= _name_noise(variables["noise_scale"], recorded.problem.noise)
    entries = recorded.candidate.model.entries
    logs = np.array([entry.parameter.log for entry in entries], bool)
    internal = variables["effect"]
    physical = np.where(logs, np.exp(np.where(logs, internal, 0.0)), internal)
    named["effect"] = ((*dims, "effect_parameter"), physical)
    named["effect_internal"] = ((*dims, "effect_parameter"), internal)
    if "parameter_correlation" in variables:
        own = [f"{name}[{joint}]" for joint in coords["joint"] for name in LOG_PARAMETERS]
        matrix = xr.Variable((*dims, "own", "other_own"), variables["parameter_correlation"])
        named["parameter_correlation"] = matrix
        labels |= {"own": own, "other_own": own}
    chains, draws = variables["mu"].shape[:2]
    labels |= {"chain": np.arange(chains), "draw": np.arange(draws)}
    return xr.Dataset(named, {**labels, "other_joint": coords["joint"]})


def _name_noise(scale: NDArray[np.float64], noise: xr.Dataset) -> dict[str, tuple]:
    """The noise of each draw, times its scale."""
    dims, lead = ("chain", "draw"), scale.shape
    rho, white, correlation = (
        noise[f"noise_{name}"].values for name in ("autocorrelation", "white", "correlation")
    )
    return {
        "noise_scale": (dims, scale),
        "noise_sd": ((*dims, "joint"), scale[..., None] * noise["noise_sd"].values),
        "noise_autocorrelation": ((*dims, "joint"), np.broadcast_to(rho, (*lead, *rho.shape))),
        "noise_white": ((*dims, "joint"), np.broadcast_to(white, (*lead, *white.shape))),
        "noise_correlation": (
            (*dims, "joint", "other_joint"),
            np.broadcast_to(correlation, (*lead, *correlation.shape)),
        ),
    }


def build_tree(
    prepared: "Preparation",
    posterior: xr.Dataset,
    stats: xr.Dataset,
    found: Correction,
    scores: tuple[xr.DataArray, xr.Dataset, list[xr.Dataset]],
    config: Mapping[str, Any],
    rng: np.random.Generator,
) -> xr.DataTree:
    """Lay fit, predictions and scores out for ArviZ."""
    recorded, given, coords = prepared
    angles, problem = recorded.angles, recorded.problem
    noise_sd = problem.noise["noise_sd"].values
    drawn = draw_prior(given.prior, given.effects, noise_sd, rng, config["covariance"])
    prior = name_draws(drawn, coords, recorded)
    draws = config["predictive_draws"]
    observed = angles[["joint_angle", "time"]].transpose("trial", "joint", "frame")
    groups = {
        "posterior": posterior,
        "sample_stats": stats.assign(
            expansion_pareto_k=((), found.pareto_k), expansion_error=((), found.error)
        ),
        "prior": prior,
        "prior_predictive": predict_new_trials(recorded, prior, draws, rng),
        "posterior_predictive": predict_trials(recorded, posterior, draws, rng).merge(
            predict_new_trials(recorded, posterior, draws, rng)
        ),
        "log_likelihood": scores[0].to_dataset(name="recording"),
        "leave_one_out": scores[1],
        "loo_pit": compute_loo_pit(recorded, scores[2], *rng.spawn(1)),
        "prior_sensitivity": measure_prior_sensitivity(
            posterior, scores[0], given.prior, given.effects
        ),
        "observed_data": observed.reset_coords(drop=True),
        "constant_data": _describe_constants(prepared),
    }
    if "parameter_correlation" not in posterior:  # asks what the fit took for granted
        groups["independence"] = judge_independence(posterior)
    tree = xr.DataTree.from_dict({f"/{name}": group for name, group in groups.items()})
    tree.attrs["note"] = describe_fit(problem)
    return tree


def describe_fit(problem: Problem) -> str:
    """State what few trials leave open, and what the noise includes."""
    known = problem.noise["component"].values.tolist()
    found = describe_components(problem.noise, [n for n in problem.disturbed if n in known])
    includes = f"The noise includes what the residual shows. {' '.join(found)}" if found else ""
    return " ".join(part for part in (describe_limits(problem.trials.present), includes) if part)


def describe_limits(present: NDArray[np.bool_]) -> str:
    """State in a sentence what few trials leave open.

    >>> describe_limits(np.ones((2, 3), bool))
    '2 trials hardly show how parameters spread over trials: sigma is mostly its prior.'
    """
    trials = int(present.any(axis=1).sum())
    if trials == 1:
        return "One trial shows no spread: sigma is its prior, and mu is as uncertain as the trial."
    if trials < DECISIONS.few_trials:
        return (
            f"{trials} trials hardly show how parameters spread over trials: "
            "sigma is mostly its prior."
        )
    return ""


def _describe_constants(prepared: "Preparation") -> xr.Dataset:
    recorded, prior = prepared.recorded, prepared.given.prior
    frames = recorded.frames
    constants = recorded.angles[["load_time", "load_torque"]].reset_coords(drop=True)
    constants = constants.assign(
        {name: frames[name].variable for name in ("present", "used", "frame_scale")}
    )
    constants["outlier"] = frames["outlier_distance"].variable > 0
    for name in ("mu_mean", "mu_sd", "sigma_median", "sigma_log_sd"):
        constants[f"prior_{name}"] = ("parameter", getattr(prior, name))
    constants["prior_noise_log_sd"] = ((), prior.noise_log_sd)
    constants["frame_interval"] = frames["frame_interval"].variable
    problem = recorded.problem
    setting = tabulate_setting(problem.setting, problem.finger, problem.trials.name)
    return constants.assign_coords(parameter=list(LOG_PARAMETERS)).merge(setting)
