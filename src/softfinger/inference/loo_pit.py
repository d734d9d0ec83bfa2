"""PIT of each trial under the others' prediction.

Correlated frames leave these PITs valid:

    pit = P(y_rep ≤ y | y_-i), y being a trial's angle at one moment

Frames of one trial share its parameters and its noise, so PITs of frames against predictions that
know other frames of the same trial are neither uniform nor independent. Here a moment is predicted
by the other trials alone, its own parameters drawn from their population. Trials are
independent: the PITs of one joint and moment are uniform if the model is right, but for what n
trials share of one another, of order 1/n.
"""

from collections.abc import Sequence

import numpy as np
import xarray as xr
from numpy.typing import NDArray
from scipy.stats import kstest, norm

from softfinger.inference.budget import BUDGET
from softfinger.inference.decisions import DECISIONS
from softfinger.inference.disturbed import spread_disturbances
from softfinger.inference.motion import move_trials
from softfinger.inference.predictive import Recorded, draw_own, scale_noise


def compute_loo_pit(
    recorded: Recorded, others: Sequence[xr.Dataset], rng: np.random.Generator
) -> xr.Dataset:
    """Compute the PIT of every trial at some moments.

    Parameters
    ----------
    others
        For every trial what the others make likely: draws of mu_…, sigma_…, effect_internal and
        noise_sd (sample, …).
    rng
        Draws a new trial from each.

    Returns
    -------
    Dataset
        pit (trial, joint, moment), NaN where nothing was recorded; pit_time (trial, moment) [s];
        p_value (joint, moment) of Kolmogorov and Smirnov's test; smallest_p (), corrected for the
        number of tests (Bonferroni).
    """
    angles = recorded.angles
    angle = angles["joint_angle"].transpose("trial", "joint", "frame").values
    time = angles["time"].transpose("trial", "frame").values
    used, scale = recorded.frames["used"].values, scale_noise(recorded.frames)
    pit = np.full((*angle.shape[:2], len(DECISIONS.pit_shares)), np.nan)
    chosen = np.full((len(time), len(DECISIONS.pit_shares)), np.nan)
    for i, population in enumerate(others):
        index = choose_frames_array(time[i], used[i])
        chosen[i] = time[i, index]
        predicted = _draw_angles(recorded, i, thin_samples(population), chosen[i], rng)
        sd = thin_samples(population)["noise_sd"].transpose("sample", "joint").values[..., None]
        along = spread_disturbances(recorded.problem, np.array([i]), chosen[i : i + 1])[0]
        sd = np.sqrt((sd * scale[i][:, index]) ** 2 + np.sum(along**2, axis=-1))
        known = np.isfinite(predicted)
        below = norm.cdf((angle[i][:, index] - predicted) / sd)
        pit[i] = np.where(known, below, 0.0).sum(axis=0) / np.maximum(known.sum(axis=0), 1)
        pit[i][np.isnan(angle[i][:, index])] = np.nan
    p_value = np.full(pit.shape[1:], np.nan)
    for at in np.ndindex(*p_value.shape):
        known = pit[(slice(None), *at)]
        if np.isfinite(known).any():
            p_value[at] = kstest(known[np.isfinite(known)], "uniform").pvalue
    corrected = min(1.0, float(np.nanmin(p_value)) * np.isfinite(p_value).sum())
    return xr.Dataset(
        {
            "pit": (("trial", "joint", "moment"), pit),
            "pit_time": (("trial", "moment"), chosen),
            "p_value": (("joint", "moment"), p_value),
            "smallest_p": ((), corrected),
        },
        {name: angles[name].values for name in ("trial", "joint")},
    )


def thin_samples(population: xr.Dataset) -> xr.Dataset:
    """Keep at most `pit_draws` draws (sample)."""
    step = max(population.sizes["sample"] // BUDGET.pit_draws, 1)
    return population.isel(sample=slice(None, None, step))


def choose_frames_array(time: NDArray[np.float64], used: NDArray[np.bool_]) -> NDArray[np.int64]:
    """Choose used frames of one trial at given shares.

    They are the nearest to `pit_shares` of its duration.

    >>> choose_frames_array(np.arange(31.0), np.arange(31) != 10)
    array([ 0,  1,  9, 30])
    """
    places = np.flatnonzero(used)
    since = time[places] - time[places[0]]
    wanted = np.array(DECISIONS.pit_shares) * since[-1]
    return places[np.abs(since[:, None] - wanted).argmin(axis=0)]


def _draw_angles(
    recorded: Recorded,
    trial: int,
    population: xr.Dataset,
    time: NDArray[np.float64],
    rng: np.random.Generator,
) -> NDArray[np.float64]:
    """Angles (sample, joint, moment) of one new trial."""
    ordered = population.transpose("sample", ...)
    own = draw_own(ordered, 1, rng)[:, 0]
    load = tuple(recorded.angles[name].values[trial] for name in ("load_time", "load_torque"))
    return move_trials(
        recorded.problem.finger,
        recorded.candidate.model,
        own,
        ordered["effect_internal"].values,
        np.full(len(own), trial),
        time,
        load,
    )
