"""Densities of the joint angle at chosen times, for the two-stage estimate and the posterior."""

from collections.abc import Mapping
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from softfinger.progress import track_progress
from softfinger.propagation.config import PropagationConfig, read_config
from softfinger.propagation.density import compute_density_array, refine_density_array
from softfinger.propagation.hyperparameters import ESTIMATES, select_posterior, select_two_stage
from softfinger.propagation.moved import (
    DRAWS,
    Move,
    choose_draws,
    draw_normal_array,
    estimate_densities_array,
    move_population,
)
from softfinger.propagation.predictions import BOUNDS
from softfinger.propagation.protocols import (
    Protocol,
    describe_truncation,
    group_protocols,
    select_main_protocol,
)
from softfinger.propagation.quantiles import compute_quantiles_array

EDGES = (0.001, 0.25, 0.5, 0.75, 0.999)
DENSITY_FINGERS = 1024  # new trials for each draw, where densities are estimated
FARTHEST = 5.0  # interquartile ranges from the median; a heavy tail is drawn no farther


def compute_densities(
    angles: xr.Dataset,
    least_squares: xr.Dataset,
    posterior: xr.DataTree,
    config: Mapping[str, Any],
    move: Move | None = None,
) -> xr.Dataset:
    """Compute the densities of a new trial's joint angles at the chosen times.

    Parameters
    ----------
    angles, least_squares, posterior
        The artifacts of these names; the load is that of the protocol with most trials.
    config
        The propagation's block, see `PropagationConfig`.
    move
        Moves new trials of the posterior by another model than the base: their densities are then
        kernel estimates.

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
    knobs = read_config(config)
    protocol = select_main_protocol(group_protocols(angles))
    time = np.unique(np.asarray(knobs.density_times_s, float))
    two_stage = select_two_stage(least_squares)
    draws = select_posterior(posterior, knobs.draws)
    joints = track_progress(range(draws.sizes["joint"]), "densities")
    moved = None if move is None else _move_draws(move, draws, protocol, time, knobs)
    parts = [
        _compute_joint(
            two_stage.isel(joint=joint), draws.isel(joint=joint), time, protocol, knobs,
            None if moved is None else moved[:, :, joint],
        )
        for joint in joints
    ]  # fmt: skip
    dataset = xr.concat(parts, xr.IndexVariable("joint", draws["joint"].to_numpy()))
    dataset = dataset.transpose("estimate", "joint", "time", "angle", "bound")
    dataset.attrs = {
        "protocol": protocol.name,
        "protocol_n_trials": protocol.trials.size,
        "truncation": describe_truncation(knobs.c_p_truncation_sd),
    }
    return dataset


def _compute_joint(
    two_stage: xr.Dataset,
    draws: xr.Dataset,
    time: NDArray,
    protocol: Protocol,
    knobs: PropagationConfig,
    moved: NDArray | None,
) -> xr.Dataset:
    load, cut = (protocol.load_time, protocol.load_torque), knobs.c_p_truncation_sd
    point = tuple(two_stage[name].to_numpy()[0] for name in ("mu", "sigma"))
    centre = tuple(draws[name].median("draw").to_numpy() for name in ("mu", "sigma"))
    edges = [compute_quantiles_array(*point, time, *load, EDGES, cut)]
    if moved is None:
        edges.append(compute_quantiles_array(*centre, time, *load, EDGES, cut))
        angle = _space_angles(edges, knobs.density_angles)
        sets = zip(draws["mu"].to_numpy(), draws["sigma"].to_numpy(), strict=True)
        each = [compute_density_array(*population, time, *load, angle, cut) for population in sets]
        of_draws = np.stack(each)
    else:
        edges.append(np.nanquantile(moved, EDGES, axis=(0, 1)).T)
        angle = _space_angles(edges, knobs.density_angles)
        of_draws = estimate_densities_array(moved, angle)
    density, error = refine_density_array(*point, time, *load, angle, cut)
    both = np.stack([density, of_draws.mean(axis=0)])
    bound = np.quantile(of_draws, list(BOUNDS.values()), axis=0)
    return xr.Dataset(
        {
            "joint_angle": (("time", "angle"), angle),
            "density": (("estimate", "time", "angle"), both),
            "density_bound": (("bound", "time", "angle"), bound),
            "density_error": ("time", error),
            "probability_shown": (("estimate", "time"), np.trapezoid(both, angle, axis=-1)),
        },
        coords={"estimate": list(ESTIMATES), "time": time, "bound": list(BOUNDS)},
    )


def _move_draws(
    move: Move, draws: xr.Dataset, protocol: Protocol, time: NDArray, knobs: PropagationConfig
) -> NDArray[np.float64]:
    """Angles (draw, n, joint, time) of new trials, the same standard numbers on every run."""
    shape = (1, DENSITY_FINGERS, draws.sizes["joint"])
    normal = draw_normal_array(shape, np.random.default_rng(0), knobs.c_p_truncation_sd)[0]
    chosen = choose_draws(draws, DRAWS)
    return move_population(draws, chosen, normal, move, protocol, time).angle


def _space_angles(edges: list[NDArray], n: int) -> NDArray[np.float64]:
    """Angles (time, n) that show every known population at each time."""
    low, first, median, third, high = np.moveaxis(np.stack(edges), -1, 0)
    low = np.maximum(low, median - FARTHEST * (third - first))
    high = np.minimum(high, median + FARTHEST * (third - first))
    known = np.isfinite(low).all(axis=1)
    if not known.any():
        return np.full((low.shape[1], n), np.nan)
    ends = low[known].min(axis=0), high[known].max(axis=0)
    return np.linspace(*ends, n, axis=-1)
