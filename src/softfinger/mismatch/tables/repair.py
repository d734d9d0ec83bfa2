"""Comparison of base and repaired model."""

import numpy as np
import xarray as xr
from numpy.typing import NDArray
from scipy.linalg import solve_triangular

from softfinger.inference.mixed_effects_loo import compute_left_out
from softfinger.inference.problem import Problem
from softfinger.inference.setting import load_at
from softfinger.measurement.trials import Trials
from softfinger.mechanics import LOG_PARAMETERS, OWN
from softfinger.mismatch.budget import BUDGET
from softfinger.mismatch.candidates.rank import Candidate
from softfinger.mismatch.checks.locate import time_since_change
from softfinger.mismatch.checks.summary import compare_parameters, compute_residual, compute_spread
from softfinger.mismatch.decisions import DECISIONS
from softfinger.mismatch.tables.evidence import MODELS
from softfinger.mismatch.tables.predict import (
    learn_without,
    list_folds,
    list_levels,
    predict_left_out,
    rank_recordings,
    refit_without,
)


def measure_repair(
    problem: Problem,
    base: Candidate,
    final: Candidate,
    angles: xr.Dataset,
    rng: np.random.Generator,
) -> xr.Dataset:
    """Measure what a repair changes."""
    noise_sd = compute_bin_noise(problem.trials)
    recorded = _mask(problem.trials, problem.trials.angle.transpose(0, 2, 1))
    levels = list_levels(problem)
    models = (base,) if final is base else (base, final)
    parts = [
        _measure_model(problem, candidate, angles, recorded, noise_sd, levels, rng)
        for candidate in models
    ]
    parts = [parts[0], parts[-1]]  # where nothing was left out, one model is both
    table = xr.concat(parts, xr.IndexVariable("model", list(MODELS)))
    compared = compare_parameters(problem, base, final)
    share = 1.0 - compute_spread(problem, final) / compute_spread(problem, base)
    counts = [int(chosen.sum()) for chosen in levels.values()]
    return table.assign(
        bias=compared["bias"],
        explained_spread=(("joint", "parameter"), share),
        noise_sd=("joint", problem.noise["noise_sd"].values),
        recorded_angle=(("trial", "joint", "bin"), recorded),
        bin_noise_sd=(("trial", "joint", "bin"), noise_sd),
        level_n_trials=("level", np.array(counts, int)),
        **_describe_bins(problem),
    ).assign_attrs(load_unit=label_unit(angles))


def label_unit(angles: xr.Dataset) -> str:
    """Unit of the load: N m, else `command`."""
    kinds = set(angles["load_kind"].values.astype(str).tolist())
    return "N m" if kinds <= {"tension_n", "torque_nm"} else "command"


def _measure_model(
    problem: Problem,
    candidate: Candidate,
    angles: xr.Dataset,
    recorded: NDArray,
    noise_sd: NDArray,
    levels: dict[float, NDArray],
    rng: np.random.Generator,
) -> xr.Dataset:
    trials, fit = problem.trials, candidate.fit
    shape = (trials.joints, OWN)
    angle, _ = problem.simulate(candidate.model, fit.own, fit.shared)
    fitted = angle.reshape(*recorded.shape, 2).mean(axis=-1)
    square = compute_residual(problem, candidate, angles) ** 2
    count = np.isfinite(square).sum(axis=2)
    rms = np.sqrt(np.nansum(square, axis=2) / np.maximum(count, 1))
    coverage, bound, band = measure_coverage(problem, candidate, recorded, noise_sd, rng)
    error, inside = measure_levels(problem, candidate, recorded, noise_sd, levels, rng)
    mean_sd = np.sqrt(np.diag(fit.mean_covariance))
    values = {
        "population_mean": (("joint", "parameter"), fit.mean.reshape(shape)),
        "population_mean_sd": (("joint", "parameter"), mean_sd.reshape(shape)),
        "population_sd": (("joint", "parameter"), np.sqrt(compute_spread(problem, candidate))),
        "elpd": ("trial", score_left_out(problem, candidate)),
        "residual_rms": (("trial", "joint"), np.where(count > 0, rms, np.nan)),
        "fitted_angle": (("trial", "joint", "bin"), _mask(trials, fitted)),
        "coverage": (("joint", "ci_prob"), coverage),
        "coverage_bound": (("joint", "ci_prob", "bound"), bound),
        "predicted_quantile": (("quantile", "trial", "joint", "bin"), band),
        "level_error": (("level", "joint"), error),
        "level_coverage": (("level", "joint"), inside),
    }
    coords = {
        "trial": trials.name,
        "joint": np.arange(1, trials.joints + 1),
        "parameter": list(LOG_PARAMETERS),
        "ci_prob": list(DECISIONS.ci_probs),
        "bound": ["lower", "upper"],
        "quantile": list_band_limits(),
        "level": np.array(list(levels), float),
    }
    return xr.Dataset(values, coords)


def score_left_out(problem: Problem, candidate: Candidate) -> NDArray[np.float64]:
    """Leave-one-trial-out log density of each trial (trial,) [nats].

    It is NaN for one.
    """
    trials = problem.trials
    if len(trials.name) < 2:
        return np.full(1, np.nan)
    rows, logdet = trials.size[trials.protocol], trials.logdet
    return compute_left_out(candidate.fit, problem.build_prior(candidate.model), rows, logdet)


def measure_coverage(
    problem: Problem,
    candidate: Candidate,
    recorded: NDArray[np.float64],
    noise_sd: NDArray[np.float64],
    rng: np.random.Generator,
) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
    """Share of recorded angles inside left-out trials' bands.

    Its 90 % bounds and the bands themselves are returned too.

    Returns
    -------
    coverage, bound, band
        (joint, ci_prob) and (joint, ci_prob, 2), by bootstrap over trials; band
        (quantile, trial, joint, bin) [rad] that the other trials predict, without noise. All are
        NaN for one trial.
    """
    shape = (problem.trials.joints, len(DECISIONS.ci_probs))
    n = len(problem.trials.name)
    if n < 2:
        nothing = np.full((len(list_band_limits()), *recorded.shape), np.nan)
        return np.full(shape, np.nan), np.full((*shape, 2), np.nan), nothing
    groups = [(fold, learn_without(problem, candidate, fold)) for fold in list_folds(n)]
    drawn = predict_left_out(problem, candidate, groups, rng)
    band = np.where(np.isfinite(recorded), np.quantile(drawn, list_band_limits(), axis=0), np.nan)
    share = share_inside(rank_recordings(drawn, recorded, noise_sd, rng))
    again = np.stack([_mean(share[rng.integers(0, n, n)]) for _ in range(BUDGET.resamples)])
    bound = np.moveaxis(np.nanquantile(again, (0.05, 0.95), axis=0), 0, -1)
    return _mean(share), bound, band


def list_band_limits() -> list[float]:
    """Quantiles of the widest central band, and the median."""
    half = max(DECISIONS.ci_probs) / 2
    return [0.5 - half, 0.5, 0.5 + half]


def share_inside(rank: NDArray[np.float64]) -> NDArray[np.float64]:
    """Share of ranks inside each central band.

    From (trial, joint, bin) to (trial, joint, ci_prob).

    >>> share_inside(np.array([[[0.5, 0.3, 0.01, np.nan]]])).round(3)
    array([[[0.667, 0.667]]])
    """
    away = 2 * np.abs(rank - 0.5)
    known = np.isfinite(rank).sum(axis=2)
    inside = np.stack([(away < p).sum(axis=2) for p in DECISIONS.ci_probs], axis=-1)
    return np.where(known[..., None] > 0, inside / np.maximum(known[..., None], 1), np.nan)


def measure_levels(
    problem: Problem,
    candidate: Candidate,
    recorded: NDArray[np.float64],
    noise_sd: NDArray[np.float64],
    levels: dict[float, NDArray[np.bool_]],
    rng: np.random.Generator,
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Predict each load level from the others.

    Returns
    -------
    error, inside
        (level, joint): rms over time of mean recorded minus mean predicted angle [rad]; share of
        recorded angles in the 90 % band. NaN where the fit without the level fails.
    """
    shape = (len(levels), problem.trials.joints)
    error, inside = np.full(shape, np.nan), np.full(shape, np.nan)
    for row, chosen in enumerate(levels.values()):
        population = refit_without(problem, candidate, chosen)
        if population is None:
            continue
        drawn = predict_left_out(problem, candidate, [(chosen, population)], rng)
        rank = rank_recordings(drawn, recorded, noise_sd, rng)
        inside[row] = _mean(share_inside(rank))[:, DECISIONS.ci_probs.index(0.9)]
        away = recorded[chosen] - np.median(drawn[:, chosen], axis=0)
        error[row] = np.sqrt(_mean(_mean(away).T ** 2))
    return error, inside


def compute_bin_noise(trials: Trials) -> NDArray[np.float64]:
    """Noise sd (trial, joint, bin) [rad], NaN if unseen."""
    kinds = {}
    for kind in np.unique(trials.protocol):
        size = trials.size[kind]
        whitening = np.zeros((size, size))
        for row in range(size):
            begin = trials.first[kind, row]
            whitening[row, begin : row + 1] = trials.band[kind, row, : row + 1 - begin]
        root = solve_triangular(whitening, np.eye(size), lower=True)
        kinds[kind] = np.sqrt(np.sum(root**2, axis=1))
    sd = np.full((len(trials.name), trials.joints, trials.node.shape[1]), np.nan)
    for i, (kind, bins) in enumerate(zip(trials.protocol, trials.bins, strict=True)):
        present = trials.present[i]
        scale = trials.scale[i, :bins][:, present]
        sd[i, present, :bins] = (kinds[kind].reshape(bins, -1) * scale).T
    return sd


def _describe_bins(problem: Problem) -> dict[str, tuple]:
    trials = problem.trials
    empty = np.full(trials.node.shape[:2], np.nan)
    time, since, load = empty.copy(), empty.copy(), empty.copy()
    for i, bins in enumerate(trials.bins):
        time[i, :bins] = trials.node[i, :bins].mean(axis=1)
        since[i, :bins] = time_since_change(problem, i)
        load[i, :bins] = load_at(trials, i)
    dims = ("trial", "bin")
    return {"time": (dims, time), "since_change": (dims, since), "load": (dims, load)}


def _mask(trials: Trials, values: NDArray) -> NDArray:
    """Values (trial, joint, bin), NaN where unseen."""
    real = np.arange(values.shape[2]) < trials.bins[:, None]
    return np.where(real[:, None] & trials.present[:, :, None], values, np.nan)


def _mean(values: NDArray) -> NDArray:
    """Mean over the first axis; NaN where unknown."""
    known = np.isfinite(values).sum(axis=0)
    return np.where(known > 0, np.nansum(values, axis=0) / np.maximum(known, 1), np.nan)
