"""For design: whose spread to reduce.

The spread is the standard deviation of the angle when the running time ends. It is computed again
with one parameter's log-sd (q_ini: sd) halved about its median, and with that parameter taken as
its median; correlations stay as they are.
"""

from collections.abc import Sequence

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from softfinger.mechanics import OWN
from softfinger.propagation.new_trials import Source
from softfinger.propagation.populations import ESTIMATES
from softfinger.propagation.protocols import Protocol
from softfinger.propagation.routes import choose_route

CHANGES = {"halved": 0.5, "removed": 1e-6}  # what is left of σ; 1e-6 σ is nothing


def compute_design(
    sources: Sequence[Source],
    protocol: Protocol,
    running_times: Sequence[float],
    quantiles: Sequence[float],
) -> xr.Dataset:
    """Compute what less spread of one parameter brings.

    Parameters
    ----------
    running_times
        [s]
    quantiles
        Over draws of the posterior.

    Returns
    -------
    Dataset
        spread (estimate, joint, running_time) [rad]; spread_shrinkage (estimate, change, joint,
        running_time, parameter) [1]: 1 − spread after / spread before, medians over draws; and
        spread_shrinkage_quantile (change, joint, running_time, parameter, quantile).
    """
    parts = [_compute_shrinkage(source, protocol, running_times) for source in sources]
    central = xr.concat(
        [part.median("draw") for part in parts], xr.IndexVariable("estimate", list(ESTIMATES))
    )
    bounds = parts[1]["spread_shrinkage"].quantile(quantiles, dim="draw")
    return central.assign(spread_shrinkage_quantile=bounds.transpose(..., "quantile"))


def _compute_shrinkage(
    source: Source, protocol: Protocol, running_times: Sequence[float]
) -> xr.Dataset:
    time, place = np.unique(running_times, return_inverse=True)

    def spread(left: NDArray) -> NDArray[np.float64]:
        variance = choose_route(source).compute_moments(source, protocol, time, left)[1]
        return np.sqrt(variance[..., place])

    whole = spread(np.ones(OWN))
    with np.errstate(invalid="ignore"):
        shrinkage = [
            [1.0 - spread(np.where(np.arange(OWN) == k, left, 1.0)) / whole for k in range(OWN)]
            for left in CHANGES.values()
        ]
    dims = ("change", "parameter", "draw", "joint", "running_time")
    return xr.Dataset(
        {
            "spread": (dims[2:], whole),
            "spread_shrinkage": xr.Variable(dims, np.array(shrinkage)).transpose(
                "draw", "change", "joint", "running_time", "parameter"
            ),
        },
        coords={
            "change": list(CHANGES),
            "joint": source.population["joint"],
            "running_time": list(running_times),
            "parameter": source.population["parameter"],
        },
    )
