"""Bands of the joint angle beside recordings."""

from collections.abc import Mapping
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from softfinger.inference.motion import Move, move_paper_joint
from softfinger.progress import track_progress
from softfinger.propagation.config import PropagateConfig, read_config
from softfinger.propagation.left_out import (
    Weigh,
    build_posterior_weights,
    build_two_stage_weights,
)
from softfinger.propagation.new_trials import (
    NewTrials,
    Source,
    move_new_trials,
    take_quantiles_array,
)
from softfinger.propagation.populations import ESTIMATES
from softfinger.propagation.protocols import (
    Protocol,
    describe_truncation,
    group_protocols,
    name_protocols,
)
from softfinger.propagation.recordings import (
    average_recordings,
    build_time_grid,
    extract_recordings,
    find_frame_interval,
)
from softfinger.propagation.routes import choose_route
from softfinger.propagation.scores import PROBABILITIES, score_recordings
from softfinger.propagation.sources import BOUNDS, gather_sources

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
    move: Move = move_paper_joint,
) -> xr.Dataset:
    """Compute bands of new trials beside recorded ones.

    Parameters
    ----------
    angles, least_squares, posterior
        The artifacts of these names. Trials with the same load history are one protocol.

    Returns
    -------
    Dataset
        Of the angle itself, [rad]: joint_angle_mean, joint_angle_sd (estimate, protocol, joint,
        time), for the posterior the median over its draws, with joint_angle_mean_bound,
        joint_angle_sd_bound (protocol, joint, time, bound) between which 90 % of the draws lie;
        joint_angle_quantile (…, quantile) of a new trial, hyperparameters integrated.
        predicted_quantile: the same with measurement noise. recorded_mean, recorded_sd,
        recorded_quantile, recorded_n (protocol, joint, time, …). coverage (estimate, protocol,
        window, joint, ci_prob) of the predicted bands, each trial against those of the others,
        coverage_bound (…, bound) by bootstrap over trials, and crps (estimate, protocol, window,
        joint) [rad]. NaN after a protocol's end.

    Notes
    -----
    Recordings are drawn with the fitted autocorrelation of their noise. Each of these quantiles
    and scores looks at single instants, for which the noise's marginal sd alone matters.
    """
    knobs = read_config(config, PropagateConfig)
    sources = gather_sources(least_squares, posterior, knobs, rng, move)
    grid = build_time_grid(angles, knobs.band_times)
    weights = (
        build_two_stage_weights(least_squares, angles["trial"]),
        build_posterior_weights(posterior, sources[1].population, angles["trial"]),
    )
    recordings, interval = extract_recordings(angles), find_frame_interval(angles)
    protocols = group_protocols(angles)
    parts = []
    for protocol in track_progress(protocols, "bands"):
        reached = grid[grid <= protocol.duration * (1 + 1e-9)]
        time, angle = (array[protocol.trials] for array in recordings)
        models = []
        for source, weigh in zip(sources, weights, strict=True):
            quantiles, samples = move_new_trials(source, protocol, reached, interval)
            left_out = (_predict_left_out(p, samples, weigh, reached) for p in protocol.trials)
            scores = score_recordings(time, angle, reached, left_out, rng)
            model = xr.merge([_compute_moments(source, protocol, reached), quantiles])
            models.append(xr.merge([model.reindex(time=grid), scores]))
        parts.append(xr.merge([_join_estimates(models), average_recordings(time, angle, grid)]))
    names = xr.IndexVariable("protocol", [protocol.name for protocol in protocols])
    dataset = xr.concat(parts, names).transpose(*ORDER, ..., missing_dims="ignore")
    dataset = dataset.assign_coords(joint=angles["joint"].to_numpy(), time=grid)
    dataset["protocol_of_trial"] = xr.Variable(
        "trial", name_protocols(protocols, angles.sizes["trial"])
    )
    cut = describe_truncation(knobs.c_p_truncation_sd)
    dataset.attrs = {"bands_are": HONESTY, "truncation": cut}
    return dataset.assign_coords(trial=angles["trial"].to_numpy())


def _join_estimates(models: list[xr.Dataset]) -> xr.Dataset:
    """Join both estimates, with the posterior's bounds."""
    bounds = models[1][["joint_angle_mean_bound", "joint_angle_sd_bound"]]
    both = [model.drop_vars(bounds.data_vars) for model in models]
    joined = xr.concat(both, xr.IndexVariable("estimate", list(ESTIMATES)))
    return xr.merge([joined, bounds])


def _compute_moments(source: Source, protocol: Protocol, time: NDArray) -> xr.Dataset:
    """Mean, sd (joint, time) [rad]: medians and bounds."""
    mean, variance = choose_route(source).compute_moments(source, protocol, time)
    dims, data = ("joint", "time"), {}
    for name, value in (("joint_angle_mean", mean), ("joint_angle_sd", np.sqrt(variance))):
        data[name] = (dims, np.median(value, axis=0))
        bound = np.quantile(value, list(BOUNDS.values()), axis=0, method="nearest")
        data[f"{name}_bound"] = (("bound", *dims), bound)
    return xr.Dataset(data, {"time": time, "bound": list(BOUNDS)})


def _predict_left_out(
    place: int, samples: list[NewTrials | None], weigh: Weigh, time: NDArray
) -> NDArray[np.float64]:
    """Quantiles (joint, time, p) predicted by other trials."""
    predicted = np.full((len(samples), time.size, PROBABILITIES.size), np.nan)
    for joint, sample in enumerate(samples):
        if sample is not None:
            weight = weigh(place, joint, sample)
            if np.isfinite(weight).all():
                predicted[joint] = take_quantiles_array(
                    sample.ordered, sample.order, weight, PROBABILITIES
                )
    return predicted
