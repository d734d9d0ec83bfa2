"""Bands of the joint angle over time, beside the recordings, with a score of their agreement."""

from collections.abc import Callable, Mapping
from functools import partial
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from softfinger.progress import track_progress
from softfinger.propagation.config import PropagationConfig, read_config
from softfinger.propagation.hyperparameters import ESTIMATES, select_posterior, select_two_stage
from softfinger.propagation.left_out import (
    Weigh,
    build_posterior_weights,
    build_two_stage_weights,
)
from softfinger.propagation.moved import Move, predict_moved
from softfinger.propagation.predictions import (
    NewTrials,
    predict_new_trials,
    take_quantiles_array,
)
from softfinger.propagation.protocols import (
    Protocol,
    describe_truncation,
    group_protocols,
    name_protocols,
)
from softfinger.propagation.recordings import (
    build_time_grid,
    extract_recordings,
    summarise_recordings,
)
from softfinger.propagation.scores import PROBABILITIES, score_recordings

Predict = Callable[..., tuple[xr.Dataset, list[NewTrials | None]]]
ORDER = ("estimate", "protocol", "window", "joint", "time")
HONESTY = (
    "made by all trials; each trial is scored against the bands of the others, its own part taken "
    "out by importance weights"
)


def compute_bands(
    angles: xr.Dataset,
    least_squares: xr.Dataset,
    posterior: xr.DataTree,
    config: Mapping[str, Any],
    rng: np.random.Generator,
    move: Move | None = None,
) -> xr.Dataset:
    """Compute the bands of new trials' angles beside the recorded ones, for every protocol.

    Parameters
    ----------
    angles, least_squares, posterior
        The artifacts of these names. Trials with the same load history are one protocol.
    config
        The propagation's block, see `PropagationConfig`.
    move
        Moves new trials of the posterior by another model than the base.

    Returns
    -------
    Dataset
        Of the angle itself, [rad]: joint_angle_mean, joint_angle_sd (estimate, protocol, joint,
        time) from exact moments, for the posterior the median over its draws, with
        joint_angle_mean_bound, joint_angle_sd_bound (protocol, joint, time, bound) between which
        90 % of the draws lie; joint_angle_quantile (…, quantile) of a new trial, hyperparameters
        integrated. predicted_quantile: the same with measurement noise. recorded_mean, recorded_sd,
        recorded_quantile, recorded_n (protocol, joint, time, …). coverage (estimate, protocol,
        window, joint, ci_prob) of the predicted bands, each trial against those of the others,
        coverage_bound (…, bound) by bootstrap over trials, and crps (estimate, protocol, window,
        joint) [rad]. NaN after a protocol's end.
    """
    knobs = read_config(config)
    grid = build_time_grid(angles, knobs.band_times)
    populations = [select_two_stage(least_squares), select_posterior(posterior, knobs.draws)]
    weights = [
        build_two_stage_weights(least_squares, angles["trial"]),
        build_posterior_weights(posterior, populations[1], angles["trial"]),
    ]
    predict = predict_new_trials if move is None else partial(predict_moved, move)
    sources = list(zip(populations, weights, (predict_new_trials, predict), strict=True))
    recordings = extract_recordings(angles)
    protocols = group_protocols(angles)
    parts = [
        _compute_protocol(protocol, sources, recordings, grid, knobs, rng)
        for protocol in track_progress(protocols, "bands")
    ]
    names = xr.IndexVariable("protocol", [protocol.name for protocol in protocols])
    dataset = xr.concat(parts, names).transpose(*ORDER, ..., missing_dims="ignore")
    dataset = dataset.assign_coords(joint=angles["joint"].to_numpy(), time=grid)
    dataset["protocol_of_trial"] = xr.Variable(
        "trial", name_protocols(protocols, angles.sizes["trial"])
    )
    cut = describe_truncation(knobs.c_p_truncation_sd)
    dataset.attrs = {"bands_are": HONESTY, "truncation": cut}
    return dataset.assign_coords(trial=angles["trial"].to_numpy())


def _compute_protocol(
    protocol: Protocol,
    sources: list[tuple[xr.Dataset, Weigh, Predict]],
    recordings: tuple[NDArray, NDArray],
    grid: NDArray,
    knobs: PropagationConfig,
    rng: np.random.Generator,
) -> xr.Dataset:
    time, angle = (array[protocol.trials] for array in recordings)
    reached = grid[grid <= protocol.duration * (1 + 1e-9)]
    parts = []
    for population, weigh, predict in sources:
        model, samples = predict(population, protocol, reached, knobs, rng)
        left_out = (_predict_left_out(place, samples, weigh, reached) for place in protocol.trials)
        scores = score_recordings(time, angle, reached, left_out, rng)
        parts.append(xr.merge([model.reindex(time=grid), scores]))
    bounds = parts[1][["joint_angle_mean_bound", "joint_angle_sd_bound"]]
    both = xr.concat(
        [part.drop_vars(bounds.data_vars) for part in parts],
        xr.IndexVariable("estimate", list(ESTIMATES)),
    )
    return xr.merge([both, bounds, summarise_recordings(time, angle, grid)])


def _predict_left_out(
    place: int, samples: list[NewTrials | None], weigh: Weigh, time: NDArray
) -> NDArray[np.float64]:
    """Quantiles (joint, time, p) of a trial's recording as the other trials predict it."""
    predicted = np.full((len(samples), time.size, PROBABILITIES.size), np.nan)
    for joint, sample in enumerate(samples):
        if sample is not None:
            weight = weigh(place, joint, sample)
            if np.isfinite(weight).all():
                predicted[joint] = take_quantiles_array(
                    sample.ordered, sample.order, weight, PROBABILITIES
                )
    return predicted
