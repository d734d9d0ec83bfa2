"""What populations predict for new trials of one protocol."""

from typing import NamedTuple

import numpy as np
import xarray as xr
from numba import njit
from numpy.typing import NDArray

from softfinger.propagation.config import PropagationConfig
from softfinger.propagation.moments import Q_INI, compute_moments_array
from softfinger.propagation.protocols import Protocol
from softfinger.propagation.sampling import compute_angles_array, draw_parameters_array

QUANTILES = (0.05, 0.25, 0.5, 0.75, 0.95)
BOUNDS = {"lower": 0.05, "upper": 0.95}


class NewTrials(NamedTuple):
    """Sampled recordings of one joint in new trials.

    `location` (n, 4) are their parameters, logs but for q_ini; `draw` (n,) the population of each;
    `ordered` (time, n) [rad] the recorded angles in rising order, noise included, and `order`
    (time, n) whose they are.
    """

    location: NDArray[np.float64]
    draw: NDArray[np.int_]
    ordered: NDArray[np.float64]
    order: NDArray[np.int_]


def predict_new_trials(
    population: xr.Dataset,
    protocol: Protocol,
    time: NDArray[np.float64],
    knobs: PropagationConfig,
    rng: np.random.Generator,
) -> tuple[xr.Dataset, list[NewTrials | None]]:
    """Predict the joint angles of a new trial: exact moments, and quantiles from samples.

    Parameters
    ----------
    population
        mu, sigma (draw, joint, parameter), noise_sd (draw, joint) [rad].
    time
        (time,) [s]

    Returns
    -------
    Dataset
        joint_angle_mean, joint_angle_sd (joint, time) [rad], medians over draws, with
        `_bound` (joint, time, bound); joint_angle_quantile of the angle and predicted_quantile of
        its recording (joint, time, quantile).
    list of NewTrials
        The samples of each joint; None where the population is not known.
    """
    mu, sigma, noise_sd = (population[name].to_numpy() for name in ("mu", "sigma", "noise_sd"))
    data = _compute_moments(mu, sigma, time, protocol, knobs)
    n_joint = population.sizes["joint"]
    quantile = np.full((2, n_joint, time.size, len(QUANTILES)), np.nan)
    samples: list[NewTrials | None] = [None] * n_joint
    for joint in range(n_joint):
        own = mu[:, joint], sigma[:, joint]
        if np.isfinite(own).all():
            sampled = _sample_joint(*own, noise_sd[:, joint], time, protocol, knobs, rng)
            samples[joint], quantile[:, joint] = sampled
    dims = ("joint", "time", "quantile")
    data["joint_angle_quantile"] = (dims, quantile[0])
    data["predicted_quantile"] = (dims, quantile[1])
    coords = {"time": time, "quantile": list(QUANTILES), "bound": list(BOUNDS)}
    return xr.Dataset(data, coords), samples


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


def _sample_joint(
    mu: NDArray,
    sigma: NDArray,
    noise_sd: NDArray,
    time: NDArray,
    protocol: Protocol,
    knobs: PropagationConfig,
    rng: np.random.Generator,
) -> tuple[NewTrials, NDArray]:
    """Samples of a joint, and quantiles (2, time, quantile) of its angle and its recording."""
    n = knobs.band_samples
    parameters, draw, z = draw_parameters_array(mu, sigma, n, rng, knobs.c_p_truncation_sd)
    angle = compute_angles_array(parameters, time, protocol.load_time, protocol.load_torque).T
    recording = angle + noise_sd[draw] * z
    ordered, order = zip(*(order_samples_array(a) for a in (angle, recording)), strict=True)
    even = np.full(n, 1 / n)
    quantile = [
        take_quantiles_array(*a, even, np.array(QUANTILES))
        for a in zip(ordered, order, strict=True)
    ]
    location = np.column_stack([np.log(parameters[:, :Q_INI]), parameters[:, Q_INI]])
    return NewTrials(location, draw, ordered[1], order[1]), np.stack(quantile)


def order_samples_array(values: NDArray[np.float64]) -> tuple[NDArray, NDArray]:
    """Put values (time, n) in rising order; also give the place from which each came."""
    values = np.ascontiguousarray(values)
    order = np.argsort(values, axis=1)
    return np.take_along_axis(values, order, axis=1), order


@njit(cache=True)
def take_quantiles_array(
    ordered: NDArray[np.float64],
    order: NDArray[np.int_],
    weight: NDArray[np.float64],
    probability: NDArray[np.float64],
) -> NDArray[np.float64]:
    """Take quantiles (time, p) of weighted values (time, n) in rising order.

    A value stands in the middle of its own weight; between values a straight line.

    Parameters
    ----------
    ordered, order
        As `order_samples_array` gives them.
    weight
        (n,), of sum 1, in the order before sorting.
    probability
        (p,), rising.

    Examples
    --------
    >>> values, order = order_samples_array(np.array([[4.0, 1.0, 2.0]]))
    >>> take_quantiles_array(values, order, np.full(3, 1 / 3), np.array([0.0, 0.5, 2 / 3]))
    array([[1., 2., 3.]])
    """
    n = ordered.shape[1]
    out = np.empty((ordered.shape[0], probability.size))
    for t in range(ordered.shape[0]):
        i = 0
        below = 0.0  # weight of the values before i
        before, place = -1.0, 0.5 * weight[order[t, 0]]  # where i − 1 and i stand
        for p in range(probability.size):
            while i < n - 1 and place < probability[p]:
                below += weight[order[t, i]]
                i += 1
                before, place = place, below + 0.5 * weight[order[t, i]]
            if i == 0 or place <= probability[p]:
                out[t, p] = ordered[t, i]
            else:
                share = (probability[p] - before) / (place - before)
                out[t, p] = ordered[t, i - 1] + share * (ordered[t, i] - ordered[t, i - 1])
    return out
