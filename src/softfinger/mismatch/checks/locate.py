"""Where a model misses, within and between trials.

Within trials, a cell of joint × phase × time since the change of load contains whitened residuals,
of unit variance if the model is right: their mean square and their mean over trials are tested.
Between trials, each trial's own parameters are tested against everything that differs between
trials. p-values are limited by a false-discovery rate (Benjamini, Hochberg 1995, J. R. Stat.
Soc. B 57, 289).
"""

import numpy as np
import xarray as xr
from numpy.typing import NDArray
from scipy.stats import chi2, false_discovery_control, norm, spearmanr

from softfinger.inference.problem import Problem
from softfinger.inference.reduce import whiten_residual
from softfinger.inference.setting import load_at
from softfinger.mechanics import LOG_PARAMETERS, OWN
from softfinger.mismatch.candidates.rank import Candidate
from softfinger.mismatch.decisions import DECISIONS

PHASES = ("rest", "loading", "holding", "unloading")


def whiten_all(problem: Problem, candidate: Candidate) -> list[NDArray[np.float64]]:
    """Whitened residuals (bin, joint) of each trial's mode."""
    angle, _ = problem.simulate(candidate.model, candidate.fit.own, candidate.fit.shared)
    return [whiten_residual(problem.trials, angle, i) for i in range(len(problem.trials.name))]


def time_since_change(problem: Problem, trial: int) -> NDArray[np.float64]:
    """Time [s] (bin,) since load change or start."""
    trials = problem.trials
    time = trials.node[trial, : trials.bins[trial]].mean(axis=1)
    edges = np.concatenate([[min(time[0], 0.0)], trials.changes[trial]])
    edges = np.sort(edges)
    return time - edges[np.maximum(np.searchsorted(edges, time, side="right") - 1, 0)]


def label_phase(problem: Problem, trial: int) -> NDArray[np.int64]:
    """Phase (bin,) of the load, from PHASES."""
    load = load_at(problem.trials, trial)
    top = max(np.abs(load).max(), 1e-300)
    time = problem.trials.node[trial, : problem.trials.bins[trial]].mean(axis=1)
    slope = np.gradient(np.abs(load), time) if len(time) > 1 else np.zeros_like(load)
    moving = np.abs(slope) * (time[-1] - time[0]) > DECISIONS.loading * top
    phase = np.where(np.abs(load) < DECISIONS.at_rest * top, 0, 2)
    return np.where(moving, np.where(slope > 0, 1, 3), phase)


def locate_within(problem: Problem, candidate: Candidate) -> xr.Dataset:
    """Test every cell of joint × phase × time.

    The time is that since the change of load.

    Returns
    -------
    Dataset
        mean_square, mean, count, p_value, q_value (joint, phase, window); NaN for an empty cell.
    """
    white = whiten_all(problem, candidate)
    shape = (problem.trials.joints, len(PHASES), len(DECISIONS.windows_s) - 1)
    total, square, count = np.zeros(shape), np.zeros(shape), np.zeros(shape)
    for i, rows in enumerate(white):
        window = np.searchsorted(DECISIONS.windows_s, time_since_change(problem, i), side="right")
        place = label_phase(problem, i), np.clip(window - 1, 0, shape[2] - 1)
        for j in np.flatnonzero(problem.trials.present[i]):
            np.add.at(total[j], place, rows[:, j])
            np.add.at(square[j], place, rows[:, j] ** 2)
            np.add.at(count[j], place, 1)
    full = count >= DECISIONS.least_count
    with np.errstate(invalid="ignore", divide="ignore"):
        scatter = chi2.sf(square, np.maximum(count, 1))
        shift = 2 * norm.sf(np.abs(total) / np.sqrt(count))
        p_value = np.where(full, np.minimum(1.0, 2 * np.minimum(scatter, shift)), np.nan)
        mean_square, mean = square / count, total / count
    q_value = np.full(shape, np.nan)
    q_value[full] = false_discovery_control(np.clip(p_value[full], 1e-300, 1.0))
    dims = ("joint", "phase", "window")
    return xr.Dataset(
        {
            "mean_square": (dims, np.where(full, mean_square, np.nan)),
            "mean": (dims, np.where(full, mean, np.nan)),
            "count": (dims, count),
            "p_value": (dims, p_value),
            "q_value": (dims, q_value),
        },
        coords={
            "joint": np.arange(1, shape[0] + 1),
            "phase": list(PHASES),
            "window": np.array(DECISIONS.windows_s[:-1]),
        },
    )


def locate_between(problem: Problem, candidate: Candidate) -> xr.Dataset:
    """Test each joint's own parameters against trial covariates.

    These are everything that differs between trials.

    Returns
    -------
    Dataset
        correlation, p_value, q_value (joint, parameter, covariate): Spearman's rank correlation of
        the trials' modes; empty `covariate` where nothing differs or trials are few.
    """
    covariates = list_trial_covariates(problem)
    trials, joints = len(problem.trials.name), problem.trials.joints
    own = candidate.fit.own.reshape(trials, joints, OWN)
    shape = (joints, OWN, len(covariates))
    correlation, p_value = np.full(shape, np.nan), np.full(shape, np.nan)
    for k, values in enumerate(covariates.values()):
        for j in range(joints):
            seen = problem.trials.present[:, j] & np.isfinite(values)
            if seen.sum() < DECISIONS.least_trials or np.ptp(values[seen]) == 0:
                continue
            for parameter in range(OWN):
                if np.ptp(own[seen, j, parameter]) > 0:
                    test = spearmanr(own[seen, j, parameter], values[seen])
                    correlation[j, parameter, k] = test.statistic
                    p_value[j, parameter, k] = test.pvalue
    q_value = np.full(shape, np.nan)
    known = np.isfinite(p_value)
    if known.any():
        q_value[known] = false_discovery_control(np.clip(p_value[known], 1e-300, 1.0))
    dims = ("joint", "parameter", "covariate")
    return xr.Dataset(
        {
            "correlation": (dims, correlation),
            "p_value": (dims, p_value),
            "q_value": (dims, q_value),
        },
        coords={
            "joint": np.arange(1, joints + 1),
            "parameter": list(LOG_PARAMETERS),
            "covariate": list(covariates),
        },
    )


def list_trial_covariates(problem: Problem) -> dict[str, NDArray[np.float64]]:
    """List what differs between trials."""
    setting = problem.setting
    largest = np.abs(problem.trials.load_torque).max(axis=1)
    before = np.concatenate([[np.nan], largest[:-1]])
    rest = np.where(np.isfinite(setting.rest_time), setting.rest_time, np.nan)
    found = {
        "trial_number": setting.number,
        "largest_load": largest,
        "largest_load_before": before,
        "rest_s": rest,
        **setting.covariates,
    }
    known = {name: v[np.isfinite(v)] for name, v in found.items()}
    return {
        name: found[name]
        for name, v in known.items()
        if len(v) >= DECISIONS.least_trials and np.ptp(v) > 1e-3 * max(np.abs(v).max(), 1e-300)
    }


def find_window(
    problem: Problem, base: Candidate, final: Candidate, share: float = 0.8
) -> tuple[float, float]:
    """Times [s] since the change that an effect fills."""
    before, after = whiten_all(problem, base), whiten_all(problem, final)
    since = np.concatenate([time_since_change(problem, i) for i in range(len(before))])
    change = np.concatenate(
        [np.nansum((a - b) ** 2, axis=1) for a, b in zip(after, before, strict=True)]
    )
    order = np.argsort(since)
    weight = np.cumsum(change[order]) / max(change.sum(), 1e-300)
    edge = (1 - share) / 2
    return tuple(float(since[order][np.searchsorted(weight, p)]) for p in (edge, 1 - edge))
