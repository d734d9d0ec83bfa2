"""What the model expects to record."""

from typing import NamedTuple

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from softfinger.inference.budget import BUDGET
from softfinger.inference.correlation import (
    Covariance,
    correlate_free_partials_array,
    shape_free_partials,
)
from softfinger.inference.density import Effects
from softfinger.inference.disturbed import spread_disturbances
from softfinger.inference.motion import move_trials
from softfinger.inference.priors import PopulationPrior
from softfinger.inference.problem import Candidate, Problem
from softfinger.inference.simulate import draw_noise_array, group_clocks
from softfinger.mechanics import LOG_PARAMETERS

LARGEST_LOG = 300.0  # a prior draw beyond it would leave the floating-point range


class Recorded(NamedTuple):
    """The trials whose recordings are predicted.

    `frames` is what `measure` makes of `angles`, both of the problem's trials.
    """

    problem: Problem
    candidate: Candidate
    angles: xr.Dataset
    frames: xr.Dataset


def draw_prior(
    prior: PopulationPrior,
    effects: Effects,
    noise_sd: NDArray[np.float64],
    rng: np.random.Generator,
    covariance: Covariance = "independent",
) -> dict[str, NDArray]:
    """Draw population, effects and noise from the prior.

    They are the model's variables, (1, draw, …).

    Parameters
    ----------
    noise_sd
        (joint,) [rad], as estimated.
    covariance
        Which parameters may be correlated.
    """
    joints = len(noise_sd)
    lead, shape = (1, BUDGET.prior_draws), (1, BUDGET.prior_draws, joints, 4)
    mu = rng.normal(prior.mu_mean, prior.mu_sd, shape)
    sigma = np.exp(rng.normal(np.log(prior.sigma_median), prior.sigma_log_sd, shape))
    effect = rng.normal(effects.mean, effects.sd, (*lead, len(effects.names)))
    drawn = {
        "mu": mu.reshape(*lead, -1),
        "sigma": sigma.reshape(*lead, -1),
        "effect": np.clip(effect, effects.bounded.low, effects.bounded.high),
        "noise_scale": np.exp(rng.normal(0.0, prior.noise_log_sd, lead)),
    }
    if covariance != "independent":
        beta = shape_free_partials(joints, covariance)
        partial = 2 * rng.beta(beta, beta, (*lead, len(beta))) - 1
        drawn["parameter_correlation"] = correlate_free_partials_array(partial, joints, covariance)
    return drawn


def predict_trials(
    recorded: Recorded, posterior: xr.Dataset, draws: int, rng: np.random.Generator
) -> xr.Dataset:
    """Draw recordings of the same trials.

    joint_angle (chain, draw, trial, joint, moment) [rad].

    `moment` counts evenly spaced frames of each trial; their times are in `predicted_time`.
    """
    chosen = thin_draws(posterior, draws)
    own = np.stack(
        [
            chosen[name].transpose("chain", "draw", "trial", "joint").values
            for name in LOG_PARAMETERS
        ],
        axis=-1,
    )
    like = np.arange(own.shape[2])
    return _record(recorded, like, own, chosen, rng)


def predict_new_trials(
    recorded: Recorded, population: xr.Dataset, draws: int, rng: np.random.Generator
) -> xr.Dataset:
    """Draw recordings of new trials.

    There is one under each load history, at most `predicted_protocols`.

    Returns
    -------
    Dataset
        new_joint_angle (chain, draw, like_trial, joint, moment) [rad]; `like_trial` names a trial
        that had the same load history; new_predicted_time (like_trial, moment) [s].
    """
    chosen = thin_draws(population, draws)
    angles = recorded.angles
    load = np.stack([angles[name].values for name in ("load_time", "load_torque")], axis=1)
    _, first = np.unique(load.reshape(len(load), -1), axis=0, return_index=True)
    some = np.linspace(0, len(first) - 1, min(len(first), BUDGET.predicted_protocols)).astype(int)
    like = np.sort(first)[some]
    own = draw_own(chosen, len(like), rng)
    drawn = _record(recorded, like, own, chosen, rng)
    renamed = {name: f"new_{name}" for name in drawn.data_vars}
    return drawn.rename({**renamed, "trial": "like_trial"})


def draw_own(population: xr.Dataset, trials: int, rng: np.random.Generator) -> NDArray[np.float64]:
    """Draw new trials' η (…, trial, joint, 4).

    The population's sample dims come first.
    """
    standard = draw_standard(population, trials, rng)
    mu, sigma = (
        np.stack([population[f"{level}_{name}"].values for name in LOG_PARAMETERS], axis=-1)
        for level in ("mu", "sigma")
    )
    own = mu[..., None, :, :] + sigma[..., None, :, :] * standard
    return np.clip(own, -LARGEST_LOG, LARGEST_LOG)


def draw_standard(
    population: xr.Dataset, trials: int, rng: np.random.Generator
) -> NDArray[np.float64]:
    """Draw new trials' (η − μ)/σ.

    They are as correlated as each draw of a population has them.

    Returns
    -------
    (…, trial, joint, 4), the population's sample dims first.
    """
    mean = population["mu_q_ini"]
    lead, joints = mean.shape[:-1], mean.sizes["joint"]
    drawn = rng.standard_normal((*lead, trials, joints * len(LOG_PARAMETERS)))
    if "parameter_correlation" in population:
        root = np.linalg.cholesky(population["parameter_correlation"].values)
        drawn = drawn @ root.swapaxes(-1, -2)
    return drawn.reshape(*lead, trials, joints, len(LOG_PARAMETERS))


def thin_draws(posterior: xr.Dataset, draws: int) -> xr.Dataset:
    """Take about `draws` draws, evenly from every chain."""
    each = max(draws // posterior.sizes["chain"], 1)
    kept = np.linspace(0, posterior.sizes["draw"] - 1, min(each, posterior.sizes["draw"]))
    return posterior.isel(draw=kept.astype(int))


def scale_noise(frames: xr.Dataset) -> NDArray[np.float64]:
    """Sd of each frame's noise over its joint's (trial, joint, frame)."""
    claimed = frames["frame_scale"].transpose("trial", "frame").values
    return frames["noise_factor"].transpose("trial", "joint", "frame").values * claimed[:, None]


def _thin_frames(
    recorded: Recorded, like: NDArray[np.int64]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Take even frames of trials.

    Returns
    -------
    time, scale
        (trial, moment) [s], NaN where there are fewer, and (trial, joint, moment), what their
        noise is over the joint's.
    """
    time = recorded.angles["time"].transpose("trial", "frame").values
    scale = scale_noise(recorded.frames)
    times = np.full((len(like), BUDGET.predicted_frames), np.nan)
    scales = np.ones((len(like), scale.shape[1], BUDGET.predicted_frames))
    for i, trial in enumerate(like):
        index = np.flatnonzero(recorded.frames["used"].values[trial])
        if len(index) > 0:
            step = max(len(index) // BUDGET.predicted_frames, 1)
            some = index[::step][: BUDGET.predicted_frames]
            times[i, : len(some)] = time[trial, some]
            scales[i, :, : len(some)] = scale[trial][:, some]
    return times, scales


def _draw_disturbances(
    disturbed: NDArray[np.float64], rng: np.random.Generator
) -> NDArray[np.float64]:
    """Draw disturbances (trial, joint, moment) [rad] along directions."""
    z = rng.standard_normal((len(disturbed), disturbed.shape[3]))
    return np.einsum("tjmk,tk->tjm", disturbed, z)


def _record(
    recorded: Recorded,
    like: NDArray[np.int64],
    own: NDArray[np.float64],
    draws: xr.Dataset,
    rng: np.random.Generator,
) -> xr.Dataset:
    """Move trials `like` recorded ones, and add noise.

    The noise is that of the recorded ones: as large, and with disturbances as large. η is
    (chain, draw, trial, joint, 4).
    """
    finger, model = recorded.problem.finger, recorded.candidate.model
    time, scale = _thin_frames(recorded, like)
    disturbed = spread_disturbances(recorded.problem, like, time)
    load = tuple(
        recorded.angles[name].transpose("trial", "knot").values[like]
        for name in ("load_time", "load_torque")
    )
    effect = draws["effect_internal"].transpose("chain", "draw", "effect_parameter").values
    clocks = group_clocks(time / float(recorded.frames["frame_interval"]))
    values = np.empty((*own.shape[:4], time.shape[1]))
    for chain, draw in np.ndindex(*own.shape[:2]):
        phi = np.tile(effect[chain, draw], (len(like), 1))
        values[chain, draw] = move_trials(finger, model, own[chain, draw], phi, like, time, load)
        noise = draws.isel(chain=chain, draw=draw)
        for rows, clock in clocks:
            drawn = draw_noise_array(clock, noise, len(rows), rng)
            values[chain, draw, rows] += drawn * scale[rows]
        values[chain, draw] += _draw_disturbances(disturbed, rng)
    coords = {name: draws[name] for name in ("chain", "draw", "joint")}
    coords["trial"] = recorded.angles["trial"].values[like]
    return xr.Dataset(
        {
            "joint_angle": (("chain", "draw", "trial", "joint", "moment"), values),
            "predicted_time": (("trial", "moment"), time),
        },
        coords=coords,
    )
