"""Sobol indices over time for the two-stage estimate and for the posterior, with their bounds."""

from collections.abc import Mapping
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from softfinger.propagation.config import PropagationConfig, read_config
from softfinger.propagation.design import compute_design
from softfinger.propagation.hyperparameters import ESTIMATES, select_posterior, select_two_stage
from softfinger.propagation.indices import PAIR_NAMES, compute_sobol_array
from softfinger.propagation.moments import compute_moments_array
from softfinger.propagation.moved import Move, estimate_indices, estimate_shrinkage
from softfinger.propagation.protocols import (
    Protocol,
    describe_truncation,
    group_protocols,
    select_main_protocol,
)

QUANTILES = (0.05, 0.5, 0.95)
DEFINITION = (
    "variance-based Sobol indices of the joint angle with independent parameters; the log-normal "
    "populations of k_v, c_v, c_p and the normal one of q_ini vary, the measurement noise does not"
)


def compute_sobol(
    angles: xr.Dataset,
    least_squares: xr.Dataset,
    posterior: xr.DataTree,
    config: Mapping[str, Any],
    rng: np.random.Generator | None = None,
    move: Move | None = None,
) -> xr.Dataset:
    """Compute which parameter's spread causes the spread of the joint angle, over time.

    Parameters
    ----------
    angles, least_squares, posterior
        The artifacts of these names; the load is that of the protocol with most trials.
    config
        The propagation's block, see `PropagationConfig`.
    rng, move
        Moves new trials of the posterior by another model than the base: indices and spread are
        then estimated from samples, and a parameter's index is that of all joints together.

    Returns
    -------
    Dataset
        first_order, total (estimate, joint, time, parameter), second_order (estimate, joint, time,
        pair): for the posterior, means over its draws. The same with `_quantile` (joint, time, …,
        quantile): quantiles over draws of the posterior. angle_sd (estimate, joint, time) [rad],
        for the posterior the median over draws, and the design table of `compute_design`. NaN
        where the population is not known.
    """
    knobs = read_config(config)
    protocol = select_main_protocol(group_protocols(angles))
    time = build_sobol_times(protocol, knobs)
    populations = [select_two_stage(least_squares), select_posterior(posterior, knobs.draws)]
    cut = knobs.c_p_truncation_sd
    parts = [_compute_indices(populations[0], time, protocol, cut)]
    shrinkage = None
    if move is None:
        parts.append(_compute_indices(populations[1], time, protocol, cut))
    else:
        parts.append(estimate_indices(populations[1], move, protocol, time, rng, cut))
        times = knobs.running_times_s
        shrinkage = estimate_shrinkage(populations[1], move, protocol, times, rng, cut)
    means = [part.mean("draw") for part in parts]
    means = [
        mean.assign(angle_sd=part["angle_sd"].median("draw"))
        for mean, part in zip(means, parts, strict=True)
    ]
    central = xr.concat(means, xr.IndexVariable("estimate", list(ESTIMATES)))
    bounds = _compute_quantiles(parts[1])
    design = compute_design(populations, protocol, knobs.running_times_s, QUANTILES, cut, shrinkage)
    dataset = xr.merge([central, bounds, design])
    dataset.attrs = {
        "definition": DEFINITION,
        "protocol": protocol.name,
        "protocol_n_trials": protocol.trials.size,
        "truncation": describe_truncation(cut),
    }
    return dataset


def build_sobol_times(protocol: Protocol, knobs: PropagationConfig) -> NDArray[np.float64]:
    """Build the even grid of times (n,) [s] from 0 to the end of a protocol."""
    step = knobs.sobol_time_step_s
    return step * np.arange(int(protocol.duration / step + 1e-9) + 1)


def _compute_indices(
    population: xr.Dataset, time: NDArray, protocol: Protocol, cut: float | None
) -> xr.Dataset:
    mu, sigma = population["mu"].to_numpy(), population["sigma"].to_numpy()
    load = (protocol.load_time, protocol.load_torque)
    indices = compute_sobol_array(mu, sigma, time, *load, cut)
    sd = np.sqrt(compute_moments_array(mu, sigma, time, *load, cut)[1])
    series = ("draw", "joint", "time")
    return xr.Dataset(
        {
            "first_order": ((*series, "parameter"), indices.first_order),
            "total": ((*series, "parameter"), indices.total),
            "second_order": ((*series, "pair"), indices.second_order),
            "angle_sd": (series, sd),
        },
        coords={
            "joint": population["joint"],
            "time": time,
            "parameter": population["parameter"],
            "pair": list(PAIR_NAMES),
        },
    )


def _compute_quantiles(draws: xr.Dataset) -> xr.Dataset:
    quantiles = draws.quantile(QUANTILES, dim="draw").transpose(..., "quantile")
    return quantiles.rename({name: f"{name}_quantile" for name in draws.data_vars})
