"""What populations predict for new trials of one protocol."""

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from softfinger.propagation.config import PropagationConfig
from softfinger.propagation.moments import compute_moments_array
from softfinger.propagation.protocols import Protocol
from softfinger.propagation.sampling import compute_angles_array, draw_parameters_array

QUANTILES = (0.05, 0.25, 0.5, 0.75, 0.95)
BOUNDS = {"lower": 0.05, "upper": 0.95}
LEVELS = (np.arange(64) + 0.5) / 64  # equally probable values that stand for a prediction


def predict_new_trials(
    population: xr.Dataset,
    protocol: Protocol,
    grid: NDArray[np.float64],
    knobs: PropagationConfig,
    rng: np.random.Generator,
) -> xr.Dataset:
    """Predict the joint angles of a new trial: exact moments, and quantiles from samples.

    Parameters
    ----------
    population
        mu, sigma (draw, joint, parameter), noise_sd (draw, joint) [rad].
    grid
        (time,) [s]; after the protocol's end everything is NaN.

    Returns
    -------
    Dataset
        joint_angle_mean, joint_angle_sd (joint, time) [rad], medians over draws, with
        `_bound` (joint, time, bound); joint_angle_quantile of the angle and predicted_quantile of
        its recording (joint, time, quantile); predicted_level (joint, time, level), 64 equally
        probable values of the recording.
    """
    time = grid[grid <= protocol.duration * (1 + 1e-9)]
    arrays = [population[name].to_numpy() for name in ("mu", "sigma", "noise_sd")]
    moments = _compute_moments(*arrays[:2], time, protocol, knobs)
    samples = [
        _sample_quantiles(*(array[:, joint] for array in arrays), time, protocol, knobs, rng)
        for joint in range(population.sizes["joint"])
    ]
    names = ("joint_angle_quantile", "predicted_quantile", "predicted_level")
    lasts = ("quantile", "quantile", "level")
    quantiles = {
        name: (("joint", "time", last), np.stack(values))
        for name, last, values in zip(names, lasts, zip(*samples, strict=True), strict=True)
    }
    coords = {"time": time, "quantile": list(QUANTILES), "bound": list(BOUNDS)}
    return xr.Dataset({**moments, **quantiles}, coords).reindex(time=grid)


def _compute_moments(
    mu: NDArray, sigma: NDArray, time: NDArray, protocol: Protocol, knobs: PropagationConfig
) -> dict[str, tuple]:
    load = (protocol.load_time, protocol.load_torque)
    mean, variance = compute_moments_array(mu, sigma, time, *load, knobs.c_p_truncation_sd)
    out = {}
    for name, value in (("joint_angle_mean", mean), ("joint_angle_sd", np.sqrt(variance))):
        out[name] = (("joint", "time"), np.median(value, axis=0))
        bound = np.quantile(value, list(BOUNDS.values()), axis=0, method="nearest")
        out[f"{name}_bound"] = (("bound", "joint", "time"), bound)
    return out


def _sample_quantiles(
    mu: NDArray,
    sigma: NDArray,
    noise_sd: NDArray,
    time: NDArray,
    protocol: Protocol,
    knobs: PropagationConfig,
    rng: np.random.Generator,
) -> tuple[NDArray, NDArray, NDArray]:
    """Quantiles of the angle (time, quantile), of its recording, and its levels (time, level)."""
    if not np.isfinite([mu, sigma]).all():
        return tuple(
            np.full((time.size, n), np.nan) for n in (len(QUANTILES),) * 2 + (LEVELS.size,)
        )
    parameters, draw, z = draw_parameters_array(
        mu, sigma, knobs.band_samples, rng, knobs.c_p_truncation_sd
    )
    angle = compute_angles_array(parameters, time, protocol.load_time, protocol.load_torque)
    recording = angle + (noise_sd[draw] * z)[:, None]
    angle, recording = (np.sort(np.ascontiguousarray(a.T), axis=1) for a in (angle, recording))
    quantiles = (take_quantiles_array(a, np.array(QUANTILES)) for a in (angle, recording))
    return (*quantiles, take_quantiles_array(recording, LEVELS))


def take_quantiles_array(
    ordered: NDArray[np.float64], probability: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Take quantiles (…, p) of values (…, n) in rising order, value i at (i + ½)/n.

    >>> take_quantiles_array(np.array([1.0, 2.0, 4.0]), np.array([0.0, 0.5, 2 / 3]))
    array([1., 2., 3.])
    """
    place = np.clip(probability * ordered.shape[-1] - 0.5, 0, ordered.shape[-1] - 1)
    below = np.floor(place).astype(int)
    above = np.minimum(below + 1, ordered.shape[-1] - 1)
    share = place - below
    return ordered[..., below] * (1 - share) + ordered[..., above] * share
