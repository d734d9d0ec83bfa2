"""What the model expects to record: of the trials that were, of new ones, and before any data."""

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from softfinger.population.correlation import (
    Covariance,
    correlate_free_partials_array,
    shape_free_partials,
    shape_partials,
)
from softfinger.population.likelihood import PARAMETERS
from softfinger.population.priors import Prior
from softfinger.population.simulate import compute_motion, draw_noise_array, group_clocks

PRIOR_DRAWS = 1000
PREDICTED_FRAMES = 60  # of each trial, evenly spaced
MOST_PROTOCOLS = 8
LOGS = PARAMETERS[:3]
LARGEST_LOG = 300.0  # a prior draw beyond it would leave the floating-point range


def draw_prior(
    prior: Prior, joints: int, rng: np.random.Generator, covariance: Covariance = "independent"
) -> dict[str, NDArray]:
    """Draw population and noise (1, draw, …) from the prior, as the model's variables."""
    shape = (1, PRIOR_DRAWS, joints, 4)
    mu = rng.normal(prior.mu_mean, prior.mu_sd, shape)
    sigma = np.exp(rng.normal(np.log(prior.sigma_median), prior.sigma_log_sd, shape))
    lead = (1, PRIOR_DRAWS)
    noise = rng.normal(np.log(prior.noise_median), prior.noise_log_sd, (*lead, joints))
    beta = shape_partials(joints)
    drawn = {
        "mu": mu.reshape(*lead, -1),
        "sigma": sigma.reshape(*lead, -1),
        "noise_sd": np.exp(noise),
        "noise_autocorrelation": rng.uniform(size=(*lead, joints)),
        "noise_partial": 2 * rng.beta(beta, beta, (*lead, len(beta))) - 1,
    }
    if covariance != "independent":
        beta = shape_free_partials(joints, covariance)
        partial = 2 * rng.beta(beta, beta, (*lead, len(beta))) - 1
        drawn["parameter_correlation"] = correlate_free_partials_array(partial, joints, covariance)
    return drawn


def predict_trials(
    angles: xr.Dataset,
    frames: xr.Dataset,
    posterior: xr.Dataset,
    draws: int,
    rng: np.random.Generator,
) -> xr.Dataset:
    """Draw recordings of the very trials: joint_angle (chain, draw, trial, joint, moment) [rad].

    `moment` counts evenly spaced frames of each trial; their times are in `predicted_time`.
    """
    chosen = thin_draws(posterior, draws)
    thinned = _thin_frames(angles, frames)
    parameters = chosen[[*PARAMETERS]]
    return _record(thinned, parameters, chosen, rng)


def predict_new_trials(
    angles: xr.Dataset,
    frames: xr.Dataset,
    population: xr.Dataset,
    draws: int,
    rng: np.random.Generator,
) -> xr.Dataset:
    """Draw recordings of new trials under each load history, at most `MOST_PROTOCOLS` of them.

    Returns
    -------
    Dataset
        new_joint_angle (chain, draw, like_trial, joint, moment) [rad]; `like_trial` names a trial
        that had the same load history; new_predicted_time (like_trial, moment) [s].
    """
    chosen = thin_draws(population, draws)
    load = np.stack([angles[name].values for name in ("load_time", "load_torque")], axis=1)
    _, first = np.unique(load.reshape(len(load), -1), axis=0, return_index=True)
    some = np.linspace(0, len(first) - 1, min(len(first), MOST_PROTOCOLS)).astype(int)
    first = np.sort(first)[some]
    thinned = _thin_frames(angles.isel(trial=first), frames.isel(trial=first))
    shape = (*(chosen.sizes[d] for d in ("chain", "draw")), len(first), chosen.sizes["joint"])
    parameters = xr.Dataset()
    standard = draw_standard(chosen, shape[2], rng)
    for k, name in enumerate(PARAMETERS):
        spread = chosen[f"sigma_{name}"].values[:, :, None] * standard[..., k]
        values = chosen[f"mu_{name}"].values[:, :, None] + spread
        parameters[name] = (("chain", "draw", "trial", "joint"), values)
    recorded = _record(thinned, parameters, chosen, rng)
    renamed = {name: f"new_{name}" for name in recorded.data_vars}
    return recorded.rename({**renamed, "trial": "like_trial"})


def draw_standard(
    population: xr.Dataset, trials: int, rng: np.random.Generator
) -> NDArray[np.float64]:
    """Draw new trials' (η − μ)/σ, as correlated as each draw of a population has them.

    Returns
    -------
    (…, trial, joint, 4), led by the population's sample dims.
    """
    mean = population["mu_q_ini"]
    lead, joints = mean.shape[:-1], mean.sizes["joint"]
    drawn = rng.standard_normal((*lead, trials, joints * len(PARAMETERS)))
    if "parameter_correlation" in population:
        root = np.linalg.cholesky(population["parameter_correlation"].values)
        drawn = drawn @ root.swapaxes(-1, -2)
    return drawn.reshape(*lead, trials, joints, len(PARAMETERS))


def thin_draws(posterior: xr.Dataset, draws: int) -> xr.Dataset:
    """Take about `draws` draws in all, evenly from every chain."""
    each = max(draws // posterior.sizes["chain"], 1)
    kept = np.linspace(0, posterior.sizes["draw"] - 1, min(each, posterior.sizes["draw"]))
    return posterior.isel(draw=kept.astype(int))


def _thin_frames(angles: xr.Dataset, frames: xr.Dataset) -> xr.Dataset:
    """Replace the frames by evenly spaced used ones; trials without any keep NaN times."""
    time = angles["time"].transpose("trial", "frame").values
    thinned = np.full((len(time), PREDICTED_FRAMES), np.nan)
    for i, used in enumerate(frames["used"].values):
        index = np.flatnonzero(used)
        if len(index) > 0:
            step = max(len(index) // PREDICTED_FRAMES, 1)
            some = index[::step][:PREDICTED_FRAMES]
            thinned[i, : len(some)] = time[i, some]
    kept = angles[["load_time", "load_torque"]]
    interval = float(frames["frame_interval"])
    return kept.assign(time=(("trial", "frame"), thinned), frame_interval=((), interval))


def _record(
    thinned: xr.Dataset, parameters: xr.Dataset, noise: xr.Dataset, rng: np.random.Generator
) -> xr.Dataset:
    bounded = {name[4:]: parameters[name].clip(-LARGEST_LOG, LARGEST_LOG) for name in LOGS}
    natural = parameters.assign({name: np.exp(log) for name, log in bounded.items()})
    motion = compute_motion(thinned, natural).transpose("chain", "draw", "trial", "joint", "frame")
    values = motion.values.copy()
    clocks = group_clocks(thinned["time"].values / float(thinned["frame_interval"]))
    for chain, draw in np.ndindex(*values.shape[:2]):
        own = noise.isel(chain=chain, draw=draw)
        for rows, clock in clocks:
            values[chain, draw, rows] += draw_noise_array(clock, own, len(rows), rng)
    coords = {name: noise[name] for name in ("chain", "draw", "joint")}
    coords["trial"] = thinned["trial"]
    return xr.Dataset(
        {
            "joint_angle": (("chain", "draw", "trial", "joint", "moment"), values),
            "predicted_time": (("trial", "moment"), thinned["time"].values),
        },
        coords=coords,
    )
