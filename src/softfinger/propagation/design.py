"""For design: whose spread to reduce, and by how much the spread of the angle would shrink.

The spread is the standard deviation of the angle when the running time ends. It is computed again,
exactly, with one parameter's log-sd (q_ini: sd) halved about its median, and with that parameter
held at its median.
"""

from collections.abc import Sequence

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from softfinger.propagation.hyperparameters import ESTIMATES
from softfinger.propagation.moments import compute_moments_array
from softfinger.propagation.protocols import Protocol

CHANGES = {"halved": 0.5, "removed": 1e-6}  # what is left of σ; 1e-6 σ is nothing


def compute_design(
    populations: Sequence[xr.Dataset],
    protocol: Protocol,
    running_times: Sequence[float],
    quantiles: Sequence[float],
    c_p_truncation_sd: float | None,
    estimated: xr.Dataset | None = None,
) -> xr.Dataset:
    """Compute by how much the angle's spread shrinks when one parameter's spread is reduced.

    Parameters
    ----------
    populations
        The two-stage estimate and the posterior's draws: mu, sigma (draw, joint, parameter).
    running_times
        [s]
    quantiles
        Over draws of the posterior.
    estimated
        Spread and shrinkage of the posterior's draws, where they are known already.

    Returns
    -------
    Dataset
        spread (estimate, joint, running_time) [rad]; spread_shrinkage (estimate, change, joint,
        running_time, parameter) [1]: 1 − spread after / spread before, medians over draws; and
        spread_shrinkage_quantile (change, joint, running_time, parameter, quantile).
    """
    parts = [
        _compute_shrinkage(population, protocol, running_times, c_p_truncation_sd)
        for population in (populations if estimated is None else populations[:1])
    ]
    if estimated is not None:
        parts.append(estimated)
    central = xr.concat(
        [part.median("draw") for part in parts], xr.IndexVariable("estimate", list(ESTIMATES))
    )
    bounds = parts[1]["spread_shrinkage"].quantile(quantiles, dim="draw")
    return central.assign(spread_shrinkage_quantile=bounds.transpose(..., "quantile"))


def _compute_shrinkage(
    population: xr.Dataset, protocol: Protocol, running_times: Sequence[float], cut: float | None
) -> xr.Dataset:
    mu, sigma = population["mu"].to_numpy(), population["sigma"].to_numpy()
    factor = np.ones((len(CHANGES), 4, 4))
    for change, left in enumerate(CHANGES.values()):
        factor[change][np.diag_indices(4)] = left
    spread = _compute_spread(mu, sigma, running_times, protocol, cut)
    changed = sigma * factor[:, :, None, None, :]  # (change, changed parameter, draw, joint, 4)
    reduced = _compute_spread(mu, changed, running_times, protocol, cut)
    with np.errstate(invalid="ignore"):
        shrinkage = 1.0 - reduced / spread
    dims = ("change", "parameter", "draw", "joint", "running_time")
    return xr.Dataset(
        {
            "spread": (("draw", "joint", "running_time"), spread),
            "spread_shrinkage": xr.Variable(dims, shrinkage).transpose(
                "draw", "change", "joint", "running_time", "parameter"
            ),
        },
        coords={
            "change": list(CHANGES),
            "joint": population["joint"],
            "running_time": list(running_times),
            "parameter": population["parameter"],
        },
    )


def _compute_spread(
    mu: NDArray,
    sigma: NDArray,
    running_times: Sequence[float],
    protocol: Protocol,
    cut: float | None,
) -> NDArray[np.float64]:
    order = np.argsort(running_times)
    time = np.asarray(running_times, float)[order]
    load = (protocol.load_time, protocol.load_torque)
    variance = compute_moments_array(np.broadcast_to(mu, sigma.shape), sigma, time, *load, cut)[1]
    return np.sqrt(variance[..., np.argsort(order)])
