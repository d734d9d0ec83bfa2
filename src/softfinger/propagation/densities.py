"""Densities of the joint angle at chosen times."""

from collections.abc import Mapping
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from softfinger.inference.motion import Move, move_paper_joint
from softfinger.propagation.config import PropagateConfig, read_config
from softfinger.propagation.density import refine_density_array
from softfinger.propagation.new_trials import Source
from softfinger.propagation.populations import ESTIMATES
from softfinger.propagation.protocols import (
    Protocol,
    describe_truncation,
    group_protocols,
    select_main_protocol,
)
from softfinger.propagation.routes import choose_route
from softfinger.propagation.sources import BOUNDS, gather_sources

EDGES = (0.001, 0.25, 0.5, 0.75, 0.999)
FARTHEST = 5.0  # interquartile ranges from the median; a heavy tail is drawn no farther


def compute_densities(
    angles: xr.Dataset,
    least_squares: xr.Dataset,
    posterior: xr.DataTree,
    config: Mapping[str, Any],
    rng: np.random.Generator,
    move: Move = move_paper_joint,
) -> xr.Dataset:
    """Compute densities of a new trial's angles.

    Parameters
    ----------
    angles, least_squares, posterior
        The artifacts of these names; the load is that of the protocol with most trials.
    move
        Moves new trials of the posterior. Where that or correlated parameters leave no closed
        form, densities are kernel estimates.

    Returns
    -------
    Dataset
        density (estimate, joint, time, angle) [1/rad] at joint_angle (joint, time, angle) [rad],
        each time with angles of its own, from its 0.1 % to its 99.9 % quantile but at most five
        interquartile ranges from the median; for the posterior the mean over its draws, that is
        of a new trial, with density_bound (joint, time, angle, bound) between which 90 % of the
        draws lie. probability_shown (estimate, joint, time) lies within the angles drawn.
        density_error (joint, time) [1]: of the two-stage density, over its peak, as the largest
        change that the last refinement made. NaN where the population is not known.
    """
    knobs = read_config(config, PropagateConfig)
    two_stage, fitted = gather_sources(least_squares, posterior, knobs, rng, move)
    protocol = select_main_protocol(group_protocols(angles))
    time = np.unique(np.asarray(fitted.knobs.density_times_s, float))
    edges = [
        choose_route(source).find_quantiles(source, protocol, time, EDGES)
        for source in (two_stage, fitted)
    ]
    angle = _space_angles(np.stack(edges), fitted.knobs.density_angles)
    density, error = _refine_two_stage(two_stage, protocol, time, angle)
    mean, of_draws = choose_route(fitted).compute_densities(fitted, protocol, time, angle)
    both = np.stack([density, mean])
    shown = np.minimum(np.trapezoid(both, angle, axis=-1), 1.0)  # but for the grid's error
    bound = np.quantile(of_draws, list(BOUNDS.values()), axis=0)
    places = ("joint", "time", "angle")
    dataset = xr.Dataset(
        {
            "joint_angle": (places, angle),
            "density": (("estimate", *places), both),
            "density_bound": ((*places, "bound"), np.moveaxis(bound, 0, -1)),
            "density_error": (places[:2], error),
            "probability_shown": (("estimate", *places[:2]), shown),
        },
        coords={
            "estimate": list(ESTIMATES),
            "joint": fitted.population["joint"].to_numpy(),
            "time": time,
            "bound": list(BOUNDS),
        },
    )
    return dataset.assign_attrs(
        protocol=protocol.name,
        protocol_n_trials=protocol.trials.size,
        truncation=describe_truncation(fitted.knobs.c_p_truncation_sd),
    )


def _refine_two_stage(
    source: Source, protocol: Protocol, time: NDArray, angle: NDArray
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Two-stage density (joint, time, angle) and error (joint, time)."""
    mu, sigma = (source.population[name].to_numpy()[0] for name in ("mu", "sigma"))
    load, cut = (protocol.load_time, protocol.load_torque), source.knobs.c_p_truncation_sd
    every = zip(mu, sigma, angle, strict=True)
    found = [refine_density_array(*own, time, *load, places, cut) for *own, places in every]
    density, error = zip(*found, strict=True)
    return np.stack(density), np.stack(error)


def _space_angles(edges: NDArray[np.float64], n: int) -> NDArray[np.float64]:
    """Angles (joint, time, n) that show each known population."""
    low, first, median, third, high = np.moveaxis(edges, -1, 0)
    low = np.maximum(low, median - FARTHEST * (third - first))
    high = np.minimum(high, median + FARTHEST * (third - first))
    known = np.isfinite(low).all(axis=-1, keepdims=True)  # (source, joint, 1)
    low = np.where(known, low, np.inf).min(axis=0)
    high = np.where(known, high, -np.inf).max(axis=0)
    unknown = ~known.any(axis=0) & np.ones(low.shape, bool)
    low[unknown], high[unknown] = np.nan, np.nan
    return np.linspace(low, high, n, axis=-1)
