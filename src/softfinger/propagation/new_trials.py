"""New fingers drawn, moved and recorded with noise."""

from typing import NamedTuple

import numpy as np
import xarray as xr
from numpy.typing import NDArray
from scipy.special import ndtr, ndtri
from scipy.stats import qmc

from softfinger.compiled import compiled
from softfinger.inference.motion import Move
from softfinger.inference.simulate import draw_noise_array
from softfinger.mechanics import OWN
from softfinger.propagation.config import SpreadConfig
from softfinger.propagation.moments import C_P
from softfinger.propagation.protocols import Protocol

QUANTILES = (0.05, 0.25, 0.5, 0.75, 0.95)


class Source(NamedTuple):
    """Where new trials come from.

    `population` as `select_posterior` gives it; `seed` of the random numbers, which are the same
    at each use, so that two answers differ by what was asked and not by chance.
    """

    population: xr.Dataset
    move: Move
    knobs: SpreadConfig
    seed: int

    @property
    def joints(self) -> int:
        """How many."""
        return self.population.sizes["joint"]


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


def draw_standard_array(
    n: int, dims: int, rng: np.random.Generator, blocks: int = 1
) -> NDArray[np.float64]:
    """Draw evenly spread standard normal numbers.

    They are (block, n, dims).

    A power of two for `n` keeps each block balanced. Its points come in random order: by that of
    the sequence every second one lies in the same half.
    """
    size = 1 << int(np.ceil(np.log2(n)))
    sequence, tiny = qmc.Sobol(d=dims, rng=rng), np.finfo(float).eps
    share = np.stack([rng.permutation(sequence.random(size))[:n] for _ in range(blocks)])
    return ndtri(np.clip(share, tiny, 1 - tiny))


def place_scores_array(
    mu: NDArray[np.float64],
    sigma: NDArray[np.float64],
    score: NDArray[np.float64],
    c_p_truncation_sd: float | None,
) -> NDArray[np.float64]:
    """Place new fingers by their normal scores.

    They are (n, joint, 4).

    A cut population of c_p takes the quantiles of its normal scores, whatever goes with them.
    """
    score = score.reshape(len(score), -1, OWN).copy()
    if c_p_truncation_sd is not None:
        outside = ndtr(-c_p_truncation_sd)
        score[..., C_P] = ndtri(outside + ndtr(score[..., C_P]) * (1 - 2 * outside))
    return mu + sigma * score


def take_root_array(covariance: NDArray[np.float64]) -> NDArray[np.float64]:
    """Take the symmetric root of a covariance.

    Both are (…, p, p).

    >>> take_root_array(np.diag([4.0, 0.0]))
    array([[2., 0.],
           [0., 0.]])
    """
    value, vector = np.linalg.eigh(covariance)
    return (vector * np.sqrt(np.maximum(value, 0.0))[..., None, :]) @ vector.swapaxes(-1, -2)


def move_fingers(
    source: Source,
    draw: NDArray[np.int_],
    own: NDArray[np.float64],
    protocol: Protocol,
    time: NDArray[np.float64],
) -> NDArray[np.float64]:
    """Move fingers (n, joint, 4).

    The result is their angles (n, joint, time) [rad].

    Each is like one of the protocol's trials. NaN where the model could not be integrated.
    """
    like = protocol.trials[np.arange(len(own)) % protocol.trials.size]
    return source.move(own, draw, like, time, protocol.load_time, protocol.load_torque)


def move_new_trials(
    source: Source, protocol: Protocol, time: NDArray[np.float64], interval: float
) -> tuple[xr.Dataset, list[NewTrials | None]]:
    """Predict angles and recordings of new trials.

    Parameters
    ----------
    time
        (time,) [s]
    interval
        Median frame interval [s], over which the noise has its autocorrelation.

    Returns
    -------
    Dataset
        joint_angle_quantile of the angle and predicted_quantile of its recording (joint, time,
        quantile) [rad].
    list of NewTrials
        The samples of each joint; None where the population is not known.
    """
    rng = np.random.default_rng(source.seed)
    draw, own = draw_fingers(source, rng)
    angle = move_fingers(source, draw, own, protocol, time)
    recording = angle + draw_noise(source.population, draw, time / interval, rng)
    quantile = np.full((2, source.joints, time.size, len(QUANTILES)), np.nan)
    samples: list[NewTrials | None] = [None] * source.joints
    for joint in range(source.joints):
        known = np.isfinite(recording[:, joint]).all(axis=1)
        if known.any():
            even = np.full(known.sum(), 1 / known.sum())
            for row, values in enumerate((angle, recording)):
                ordered = order_samples_array(values[known, joint].T)
                quantile[row, joint] = take_quantiles_array(*ordered, even, np.array(QUANTILES))
            samples[joint] = NewTrials(own[known, joint], draw[known], *ordered)
    dims = ("joint", "time", "quantile")
    data = {"joint_angle_quantile": quantile[0], "predicted_quantile": quantile[1]}
    coords = {"time": time, "quantile": list(QUANTILES)}
    return xr.Dataset({name: (dims, value) for name, value in data.items()}, coords), samples


def draw_fingers(
    source: Source, rng: np.random.Generator
) -> tuple[NDArray[np.int_], NDArray[np.float64]]:
    """Draw new fingers from all populations alike.

    Returns
    -------
    draw (n,), the population of each, and own (n, joint, 4), logs but for q_ini.
    """
    population, knobs = source.population, source.knobs
    mu, sigma = (population[name].to_numpy() for name in ("mu", "sigma"))
    normal = draw_standard_array(knobs.band_samples, 1 + source.joints * OWN, rng)[0]
    draw = np.minimum((ndtr(normal[:, 0]) * len(mu)).astype(int), len(mu) - 1)
    root = take_root_array(population["correlation"].to_numpy())
    score = np.einsum("nij,nj->ni", root[draw], normal[:, 1:])
    return draw, place_scores_array(mu[draw], sigma[draw], score, knobs.c_p_truncation_sd)


def draw_noise(
    population: xr.Dataset,
    draw: NDArray[np.int_],
    clock: NDArray[np.float64],
    rng: np.random.Generator,
) -> NDArray[np.float64]:
    """Draw noise (n, joint, time) [rad], correlated as fitted.

    Parameters
    ----------
    draw
        (n,) population of each.
    clock
        (time,) in median frame intervals.
    """
    shape = population[["noise_autocorrelation", "noise_white", "noise_correlation"]]
    shape = shape.assign(noise_sd=xr.ones_like(population["noise_sd"]))
    noise = np.empty((draw.size, population.sizes["joint"], clock.size))
    for place in np.unique(draw):
        rows = np.flatnonzero(draw == place)
        noise[rows] = draw_noise_array(clock, shape.isel(draw=place), rows.size, rng)
    return noise * population["noise_sd"].to_numpy()[draw, :, None]


def order_samples_array(values: NDArray[np.float64]) -> tuple[NDArray, NDArray]:
    """Sort values (time, n); also their former places."""
    values = np.ascontiguousarray(values)
    order = np.argsort(values, axis=1)
    return np.take_along_axis(values, order, axis=1), order


@compiled
def take_quantiles_array(
    ordered: NDArray[np.float64],
    order: NDArray[np.int_],
    weight: NDArray[np.float64],
    probability: NDArray[np.float64],
) -> NDArray[np.float64]:
    """Take quantiles (time, p) of weighted values.

    The values (time, n) are in rising order.

    A value lies in the middle of its own weight; between values there is a straight line.

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
        before, place = -1.0, 0.5 * weight[order[t, 0]]  # where i − 1 and i lie
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
