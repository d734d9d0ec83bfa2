"""Answers in closed form, for the paper's joint."""

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from softfinger.progress import track_progress
from softfinger.propagation.correlated import compute_values_array
from softfinger.propagation.density import compute_density_array
from softfinger.propagation.independent import share_variance_array
from softfinger.propagation.moments import compute_moments_array
from softfinger.propagation.new_trials import Source
from softfinger.propagation.populations import relate_own_array
from softfinger.propagation.protocols import Protocol
from softfinger.propagation.quantiles import compute_quantiles_array
from softfinger.propagation.subsets import EVERY, SUBSETS, Shares, Subset

Moments = tuple[NDArray[np.float64], NDArray[np.float64]]
WHOLE = np.ones(len(EVERY))


def compute_moments(
    source: Source, protocol: Protocol, time: NDArray[np.float64], left: NDArray = WHOLE
) -> Moments:
    """Compute mean and variance of the joint angles.

    Parameters
    ----------
    time
        (n,) [s], rising.
    left
        (4,) What is left of the spread of each parameter.

    Returns
    -------
    mean, variance : (draw, joint, n) [rad], [rad²]
    """
    mu, sigma = _read_populations(source, left)
    cut = source.knobs.c_p_truncation_sd
    return compute_moments_array(mu, sigma, time, protocol.load_time, protocol.load_torque, cut)


def share_variance(source: Source, protocol: Protocol, time: NDArray[np.float64]) -> Shares:
    """Share variance out among sets (draw, joint, n)."""
    mu, sigma = _read_populations(source)
    cut = source.knobs.c_p_truncation_sd
    return share_variance_array(mu, sigma, time, protocol.load_time, protocol.load_torque, cut)


def compute_correlated_moments(
    source: Source, protocol: Protocol, time: NDArray[np.float64], left: NDArray = WHOLE
) -> Moments:
    """Compute mean and variance of correlated parameters, as `compute_moments`."""
    found = list(_compute_values(source, protocol, time, left, [EVERY]))
    return np.stack([mean for mean, _ in found]), np.stack([value[EVERY] for _, value in found])


def share_correlated_variance(
    source: Source, protocol: Protocol, time: NDArray[np.float64]
) -> Shares:
    """Share the variance out among correlated parameters, as `share_variance`."""
    every = track_progress(
        _compute_values(source, protocol, time, WHOLE, SUBSETS),
        "splitting the spread of correlated parameters",
        total=source.population.sizes["draw"],
    )
    values = [value for _, value in every]
    with np.errstate(invalid="ignore", divide="ignore"):
        return {u: np.stack([v[u] / v[EVERY] for v in values]) for u in SUBSETS}


def find_quantiles(
    source: Source, protocol: Protocol, time: NDArray[np.float64], probability: NDArray
) -> NDArray[np.float64]:
    """Find quantiles (joint, n, p) [rad] at median hyperparameters."""
    cut = source.knobs.c_p_truncation_sd
    load = (protocol.load_time, protocol.load_torque)
    centre = zip(*(np.median(a, axis=0) for a in _read_populations(source)), strict=True)
    return np.stack(
        [compute_quantiles_array(*own, time, *load, probability, cut) for own in centre]
    )


def compute_densities(
    source: Source, protocol: Protocol, time: NDArray[np.float64], angle: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Compute densities [1/rad] at angles (joint, n, a) [rad].

    Returns
    -------
    density (joint, n, a) of a new trial and (draw, joint, n, a) of every draw.
    """
    load, cut = (protocol.load_time, protocol.load_torque), source.knobs.c_p_truncation_sd
    draws = track_progress(
        zip(*_read_populations(source), strict=True),
        "densities",
        total=source.population.sizes["draw"],
    )
    every = np.stack(
        [
            [
                compute_density_array(*own, time, *load, places, cut)
                for *own, places in zip(*population, angle, strict=True)
            ]
            for population in draws
        ]
    )
    return every.mean(axis=0), every


def _read_populations(source: Source, left: NDArray = WHOLE) -> tuple[NDArray, NDArray]:
    mu, sigma = (source.population[name].to_numpy() for name in ("mu", "sigma"))
    return mu, sigma * left


def _compute_values(
    source: Source, protocol: Protocol, time: NDArray, left: NDArray, subsets: list[Subset]
) -> Iterator[tuple[NDArray, dict[Subset, NDArray]]]:
    mu, sigma = _read_populations(source, left)
    covariance = relate_own_array(source.population["correlation"].to_numpy(), sigma)
    load = (protocol.load_time, protocol.load_torque)
    # a lattice of its own for each draw: one for all is as fine as the narrowest and as long as
    # the widest, which costs a hundredfold where a single trial leaves the spread open
    draws = zip(mu, covariance, strict=True)
    return (compute_values_array(*draw, time, *load, subsets) for draw in draws)
