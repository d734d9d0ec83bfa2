"""Where each trial lies in what the others predict of it: PITs that correlated frames leave valid.

    pit = P(y_rep ≤ y | y_-i), y being a trial's angle at one moment

Frames of one trial share its parameters and its noise, so PITs of frames against predictions that
know other frames of the same trial are neither uniform nor independent. Here a moment is predicted
by the other trials alone, its own parameters drawn from their population. Over trials, which are
independent, the PITs of one joint and moment are uniform if the model is right, but for what n
trials share of one another, of order 1/n.
"""

from collections.abc import Sequence

import numpy as np
import xarray as xr
from numpy.typing import NDArray
from scipy.stats import kstest, norm

from softfinger.estimation.predictive import LARGEST_LOG, LOGS, draw_standard
from softfinger.mechanics.three_element import compute_joint_angle_array
from softfinger.population.likelihood import PARAMETERS

SHARES = (1 / 300, 1 / 30, 1 / 3, 1.0)
"""Of a trial's duration: 0.1, 1, 10 and 30 s of the paper's."""


def compute_loo_pit(
    angles: xr.Dataset,
    frames: xr.Dataset,
    others: Sequence[xr.Dataset],
    rng: np.random.Generator,
) -> xr.Dataset:
    """Compute the PIT of every trial at a few moments, and test whether they are uniform.

    Parameters
    ----------
    angles, frames
        The `angles` artifact and what `select_frames` makes of it.
    others
        For every trial, what the others say: draws of mu_…, sigma_… and noise_sd (sample, joint).
    rng
        Draws a new trial from each.

    Returns
    -------
    Dataset
        pit (trial, joint, moment), NaN where nothing was recorded; pit_time (trial, moment) [s];
        p_value (joint, moment) of Kolmogorov and Smirnov's test; smallest_p (), corrected for the
        number of tests (Bonferroni).
    """
    recorded = angles["joint_angle"].transpose("trial", "joint", "frame").values
    time = angles["time"].transpose("trial", "frame").values
    pit = np.full((*recorded.shape[:2], len(SHARES)), np.nan)
    chosen = np.full((len(time), len(SHARES)), np.nan)
    for i, population in enumerate(others):
        if frames["used"].values[i].any():
            index = choose_frames_array(time[i], frames["used"].values[i])
            chosen[i] = time[i, index]
            load = (angles[name].values[i] for name in ("load_time", "load_torque"))
            predicted = _draw_angles(population, chosen[i], *load, rng)
            sd = population["noise_sd"].transpose("sample", "joint").values[..., None]
            pit[i] = norm.cdf((recorded[i][:, index] - predicted) / sd).mean(axis=0)
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


def choose_frames_array(time: NDArray[np.float64], used: NDArray[np.bool_]) -> NDArray[np.int64]:
    """Choose the used frames of one trial that are nearest to `SHARES` of its duration.

    >>> choose_frames_array(np.arange(31.0), np.arange(31) != 10)
    array([ 0,  1,  9, 30])
    """
    places = np.flatnonzero(used)
    since = time[places] - time[places[0]]
    wanted = np.array(SHARES) * since[-1]
    return places[np.abs(since[:, None] - wanted).argmin(axis=0)]


def _draw_angles(
    population: xr.Dataset,
    time: NDArray[np.float64],
    load_time: NDArray[np.float64],
    load_torque: NDArray[np.float64],
    rng: np.random.Generator,
) -> NDArray[np.float64]:
    """Angles (sample, joint, moment) of one new trial for every draw of a population."""
    values = []
    standard = draw_standard(population, 1, rng)[:, 0]
    for k, name in enumerate(PARAMETERS):
        mu, sigma = (
            population[f"{level}_{name}"].transpose("sample", "joint").values
            for level in ("mu", "sigma")
        )
        drawn = mu + sigma * standard[..., k]
        if name in LOGS:
            drawn = np.exp(np.clip(drawn, -LARGEST_LOG, LARGEST_LOG))
        values.append(drawn)
    return compute_joint_angle_array(*values, time, load_time, load_torque)
