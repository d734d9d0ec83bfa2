"""New trials by any forward model: bands, densities and indices from samples.

For a repaired model, whose joints may depend on each other: whole fingers are drawn, some for each
of a few draws of the posterior, with the same standard normal numbers for all draws. A parameter's
Sobol index is that of the parameter at all joints together. Effects are no parameters of a trial:
they differ between draws of the posterior only.
"""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
import xarray as xr
from numpy.typing import NDArray
from scipy.special import ndtr, ndtri
from scipy.stats import qmc

from softfinger.propagation.config import PropagationConfig
from softfinger.propagation.general import estimate_density_array
from softfinger.propagation.indices import PAIR_NAMES, PAIRS
from softfinger.propagation.moments import C_P
from softfinger.propagation.predictions import (
    BOUNDS,
    QUANTILES,
    NewTrials,
    order_samples_array,
    take_quantiles_array,
)
from softfinger.propagation.protocols import Protocol

Move = Callable[[NDArray, NDArray, NDArray, NDArray, NDArray, NDArray], NDArray[np.float64]]
"""(own (m, joint, 4), draw (m,), like (m,), time (n,), load_time, load_torque) → (m, joint, n)."""

DRAWS = 24  # of the posterior
FINGERS = 256  # for each of them; a power of two
SOBOL_DRAWS, SOBOL_FINGERS = 8, 512
HALVED, REMOVED = 0.5, 0.0


class Drawn(NamedTuple):
    """Moved new trials.

    draw (k,) places of the populations; own (k, n, joint, 4); angle (k, n, joint, time) [rad].
    """

    draw: NDArray[np.int_]
    own: NDArray[np.float64]
    angle: NDArray[np.float64]


def draw_normal_array(
    shape: tuple[int, int, int], rng: np.random.Generator, c_p_truncation_sd: float | None
) -> NDArray[np.float64]:
    """Draw standard normal numbers (set, n, joint, 4), evenly spread; log c_p cut at that many sd.

    Parameters
    ----------
    shape
        Sets, n (a power of two), joints.
    """
    sets, n, joints = shape
    share = qmc.Sobol(d=sets * joints * 4, rng=rng).random_base2(int(np.log2(n)))
    share = np.moveaxis(share.reshape(n, sets, joints, 4), 1, 0)
    if c_p_truncation_sd is not None:
        outside = ndtr(-c_p_truncation_sd)
        share[..., C_P] = outside + share[..., C_P] * (1 - 2 * outside)
    tiny = np.finfo(float).eps
    return ndtri(np.clip(share, tiny, 1 - tiny))


def choose_draws(population: xr.Dataset, most: int) -> NDArray[np.int_]:
    """Choose draws of a population, evenly."""
    total = population.sizes["draw"]
    return np.unique(np.linspace(0, total - 1, min(most, total)).astype(int))


def move_population(
    population: xr.Dataset,
    draws: NDArray[np.int_],
    normal: NDArray[np.float64],
    move: Move,
    protocol: Protocol,
    time: NDArray[np.float64],
) -> Drawn:
    """Move the fingers that standard normal numbers (n, joint, 4) stand for, for each draw."""
    mu, sigma = (population[name].to_numpy()[draws] for name in ("mu", "sigma"))
    own = mu[:, None] + sigma[:, None] * normal
    k, n, joints, _ = own.shape
    draw = np.repeat(draws, n)
    like = np.tile(protocol.trials[np.arange(n) % protocol.trials.size], k)
    load = protocol.load_time, protocol.load_torque
    angle = move(own.reshape(k * n, joints, 4), draw, like, time, *load)
    return Drawn(draws, own, angle.reshape(k, n, joints, time.size))


def predict_moved(
    move: Move,
    population: xr.Dataset,
    protocol: Protocol,
    time: NDArray[np.float64],
    knobs: PropagationConfig,
    rng: np.random.Generator,
) -> tuple[xr.Dataset, list[NewTrials | None]]:
    """Predict the joint angles of a new trial, as `predict_new_trials`, by another model."""
    draws = choose_draws(population, DRAWS)
    joints = population.sizes["joint"]
    normal = draw_normal_array((1, FINGERS, joints), rng, knobs.c_p_truncation_sd)[0]
    drawn = move_population(population, draws, normal, move, protocol, time)
    whole = np.isfinite(drawn.angle).all(axis=(2, 3))
    data = _compute_moments(np.where(whole[..., None, None], drawn.angle, np.nan))
    angle, own = drawn.angle[whole], drawn.own[whole]
    draw = np.repeat(draws, FINGERS)[whole.ravel()]
    noise = population["noise_sd"].to_numpy()[draw] * rng.standard_normal((len(draw), joints))
    even = np.full(len(draw), 1 / len(draw))
    quantile = np.empty((2, joints, time.size, len(QUANTILES)))
    samples: list[NewTrials | None] = []
    for joint in range(joints):
        for row, values in enumerate((angle[:, joint], angle[:, joint] + noise[:, joint, None])):
            ordered, order = order_samples_array(values.T)
            quantile[row, joint] = take_quantiles_array(ordered, order, even, np.array(QUANTILES))
        samples.append(NewTrials(own[:, joint], draw, ordered, order))
    dims = ("joint", "time", "quantile")
    data["joint_angle_quantile"] = (dims, quantile[0])
    data["predicted_quantile"] = (dims, quantile[1])
    coords = {"time": time, "quantile": list(QUANTILES), "bound": list(BOUNDS)}
    return xr.Dataset(data, coords), samples


def _compute_moments(angle: NDArray) -> dict[str, tuple]:
    out = {}
    for name, take in (("joint_angle_mean", np.nanmean), ("joint_angle_sd", np.nanstd)):
        value = take(angle, axis=1)  # (draw, joint, time)
        out[name] = (("joint", "time"), np.median(value, axis=0))
        bound = np.quantile(value, list(BOUNDS.values()), axis=0, method="nearest")
        out[f"{name}_bound"] = (("bound", "joint", "time"), bound)
    return out


def estimate_densities_array(
    angle: NDArray[np.float64], places: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Estimate a kernel density (draw, time, place) [1/rad] for each draw (Silverman's width).

    Parameters
    ----------
    angle
        (draw, n, time) [rad], NaN = unknown.
    places
        (time, place) [rad].
    """
    density = np.empty((len(angle), *places.shape))
    for k, own in enumerate(angle):
        for t, sample in enumerate(own.T):
            known = sample[np.isfinite(sample)]
            spread = np.diff(np.quantile(known, (0.25, 0.75)))[0] / 1.349
            width = 0.9 * max(min(known.std(), spread), 1e-9) * known.size**-0.2
            density[k, t] = estimate_density_array(known, width, places[t])[0]
    return density


def estimate_indices(
    population: xr.Dataset,
    move: Move,
    protocol: Protocol,
    time: NDArray[np.float64],
    rng: np.random.Generator,
    c_p_truncation_sd: float | None,
) -> xr.Dataset:
    """Estimate Sobol indices over time for some draws of the posterior (Saltelli's estimators).

    Returns
    -------
    Dataset
        first_order, total (draw, joint, time, parameter), second_order (draw, joint, time, pair),
        angle_sd (draw, joint, time) [rad].

    References
    ----------
    Saltelli et al. (2010), Computer Physics Communications 181, 259,
    doi:10.1016/j.cpc.2009.09.018.
    """
    draws = choose_draws(population, SOBOL_DRAWS)
    shape = (2, SOBOL_FINGERS, population.sizes["joint"])
    one, two = draw_normal_array(shape, rng, c_p_truncation_sd)

    def run(normal: NDArray) -> NDArray:
        return move_population(population, draws, normal, move, protocol, time).angle

    f_one, f_two = run(one), run(two)
    centre = np.nanmean(np.concatenate([f_one, f_two], axis=1), axis=1, keepdims=True)
    variance = np.nanvar(np.concatenate([f_one, f_two], axis=1), axis=1)
    closed, total = {}, {}
    for group in [(k,) for k in range(4)] + list(PAIRS):
        mixed = one.copy()
        mixed[..., group] = two[..., group]
        f_mixed = run(mixed)
        closed[group] = np.nanmean((f_two - centre) * (f_mixed - f_one), axis=1)
        total[group] = 0.5 * np.nanmean((f_one - f_mixed) ** 2, axis=1)
    with np.errstate(invalid="ignore", divide="ignore"):
        first = np.stack([closed[k,] / variance for k in range(4)], axis=-1)
        every = np.stack([total[k,] / variance for k in range(4)], axis=-1)
        both = np.stack([closed[pair] / variance for pair in PAIRS], axis=-1)
    second = both - np.stack([first[..., a] + first[..., b] for a, b in PAIRS], axis=-1)
    series = ("draw", "joint", "time")
    return xr.Dataset(
        {
            "first_order": ((*series, "parameter"), np.clip(first, 0.0, 1.0)),
            "total": ((*series, "parameter"), np.clip(every, 0.0, 1.0)),
            "second_order": ((*series, "pair"), np.clip(second, 0.0, 1.0)),
            "angle_sd": (series, np.sqrt(variance)),
        },
        coords={
            "joint": population["joint"],
            "time": time,
            "parameter": population["parameter"],
            "pair": list(PAIR_NAMES),
        },
    )


def estimate_shrinkage(
    population: xr.Dataset,
    move: Move,
    protocol: Protocol,
    running_times: list[float],
    rng: np.random.Generator,
    c_p_truncation_sd: float | None,
) -> xr.Dataset:
    """Estimate by how much the angle's spread shrinks when one parameter's spread is reduced.

    Returns
    -------
    Dataset
        spread (draw, joint, running_time) [rad]; spread_shrinkage (draw, change, joint,
        running_time, parameter).
    """
    draws = choose_draws(population, SOBOL_DRAWS)
    shape = (1, SOBOL_FINGERS, population.sizes["joint"])
    normal = draw_normal_array(shape, rng, c_p_truncation_sd)[0]
    time = np.unique(running_times)
    place = np.searchsorted(time, running_times)

    def spread(factor: NDArray) -> NDArray:
        moved = move_population(population, draws, normal * factor, move, protocol, time)
        return np.nanstd(moved.angle, axis=1)[..., place]

    whole = spread(np.ones(4))
    shrunk = np.stack(
        [
            np.stack([spread(np.where(np.arange(4) == k, left, 1.0)) for k in range(4)], axis=-1)
            for left in (HALVED, REMOVED)
        ],
        axis=1,
    )
    with np.errstate(invalid="ignore"):
        shrinkage = 1.0 - shrunk / whole[:, None, ..., None]
    return xr.Dataset(
        {
            "spread": (("draw", "joint", "running_time"), whole),
            "spread_shrinkage": (
                ("draw", "change", "joint", "running_time", "parameter"),
                shrinkage,
            ),
        },
        coords={
            "change": ["halved", "removed"],
            "joint": population["joint"],
            "running_time": list(running_times),
            "parameter": population["parameter"],
        },
    )
