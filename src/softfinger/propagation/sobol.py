"""Sobol indices over time, with their bounds."""

from collections.abc import Mapping
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from softfinger.inference.motion import Move, move_paper_joint
from softfinger.propagation.config import ShapleyConfig, SobolConfig, read_config
from softfinger.propagation.design import compute_design
from softfinger.propagation.new_trials import Source
from softfinger.propagation.populations import ESTIMATES, are_independent
from softfinger.propagation.protocols import (
    Protocol,
    describe_truncation,
    group_protocols,
    select_main_protocol,
)
from softfinger.propagation.routes import choose_route
from softfinger.propagation.sources import gather_sources
from softfinger.propagation.subsets import PAIR_NAMES, compute_sobol_indices

QUANTILES = (0.05, 0.5, 0.95)
DEFINITION = (
    "variance-based Sobol indices of the joint angle with independent parameters. k_v, c_v and c_p "
    "(log-normal) and q_ini (normal) vary; the measurement noise does not"
)
DEPENDENT = (
    "variance-based indices of the joint angle with the fitted correlations of the parameters "
    "(those of the two-stage estimate are independent). First order is Var E[q|x] / Var q, with "
    "all that is correlated with x. Total is E Var[q|all others] / Var q, what x adds alone; "
    "it may "
    "be the smaller of the two. Second order is negative where two parameters give the same "
    "information. Shapley effects divide the variance among the parameters. The measurement noise "
    "does not vary"
)


def compute_sobol(
    angles: xr.Dataset,
    least_squares: xr.Dataset,
    posterior: xr.DataTree,
    config: Mapping[str, Any],
    rng: np.random.Generator,
    move: Move = move_paper_joint,
) -> xr.Dataset:
    """Compute which parameter's spread causes the angle's spread.

    Parameters
    ----------
    angles, least_squares, posterior
        The artifacts of these names; the load is that of the protocol with most trials.
    move
        Moves new trials of the posterior. A parameter's index is that of all joints together.

    Returns
    -------
    Dataset
        first_order, total (estimate, joint, time, parameter), second_order (estimate, joint, time,
        pair): for the posterior, means over its draws. The same with `_quantile` (joint, time, …,
        quantile): quantiles over draws of the posterior. angle_sd (estimate, joint, time) [rad],
        for the posterior the median over draws, and the design table of `compute_design`. NaN
        where the population is not known. `definition` states what the indices are.
    """
    sources = gather_sources(least_squares, posterior, read_config(config, SobolConfig), rng, move)
    protocol, knobs = select_main_protocol(group_protocols(angles)), sources[1].knobs
    time = build_sobol_times(protocol, knobs)
    estimate = xr.IndexVariable("estimate", list(ESTIMATES))
    indices = [_compute_indices(source, protocol, time) for source in sources]
    spread = [_compute_angle_sd(source, protocol, time) for source in sources]
    parts = [
        xr.concat([part.mean("draw") for part in indices], estimate),
        xr.concat([part.median("draw") for part in spread], estimate),
        compute_quantiles(indices[1]),
        compute_quantiles(spread[1]),
        compute_design(sources, protocol, knobs.running_times_s, QUANTILES),
    ]
    independent = are_independent(sources[1].population)
    return xr.merge(parts).assign_attrs(
        definition=DEFINITION if independent else DEPENDENT,
        protocol=protocol.name,
        protocol_n_trials=protocol.trials.size,
        truncation=describe_truncation(knobs.c_p_truncation_sd),
    )


def build_sobol_times(protocol: Protocol, knobs: ShapleyConfig) -> NDArray[np.float64]:
    """Even times (n,) [s] of a protocol, from 0."""
    step = knobs.sobol_time_step_s
    return step * np.arange(int(protocol.duration / step + 1e-9) + 1)


def compute_quantiles(draws: xr.Dataset) -> xr.Dataset:
    """Add each variable's `_quantile` (…, quantile) over draws."""
    quantiles = draws.quantile(QUANTILES, dim="draw").transpose(..., "quantile")
    return quantiles.rename({name: f"{name}_quantile" for name in draws.data_vars})


def _compute_indices(source: Source, protocol: Protocol, time: NDArray) -> xr.Dataset:
    shares = choose_route(source).share_variance(source, protocol, time)
    indices = compute_sobol_indices(shares)._asdict()
    last = {"first_order": "parameter", "total": "parameter", "second_order": "pair"}
    return xr.Dataset(
        {name: (("draw", "joint", "time", last[name]), value) for name, value in indices.items()},
        coords={
            "joint": source.population["joint"],
            "time": time,
            "parameter": source.population["parameter"],
            "pair": list(PAIR_NAMES),
        },
    )


def _compute_angle_sd(source: Source, protocol: Protocol, time: NDArray) -> xr.Dataset:
    variance = choose_route(source).compute_moments(source, protocol, time)[1]
    coords = {"joint": source.population["joint"], "time": time}
    return xr.Dataset({"angle_sd": (("draw", "joint", "time"), np.sqrt(variance))}, coords)
