"""Priors chosen on the scale of angles, carried to parameters by the load and the clock alone.

With K the largest load of the campaign, T its median duration under load and Δ the median frame
interval, a joint is expected to bend elastically by about half a radian, to take between a frame
and a recording to do so, and to flow by about a tenth of a radian within a recording:

    log k_v about log(K / 0.5),  log c_v about log(K / 0.5 · √(T Δ)),  log c_p about log(K T / 0.1)

each with an sd that allows factors of 20 to 50 either way. No angle is looked at, so a tension in
newtons, a torque and a bare command need no tuning.
"""

from typing import NamedTuple

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from softfinger.faults import Fault

ELASTIC_RAD, FLOW_RAD = 0.5, 0.1
MU_SD = (1.5, 2.0, 2.0, 0.5)
SIGMA_MEDIAN, SIGMA_LOG_SD = (0.3, 0.3, 0.3, 0.02), 1.0
NOISE_LOG_SD = 0.05  # of the noise's scale about its estimate


class Prior(NamedTuple):
    """μ ~ normal(mu_mean, mu_sd) and log σ ~ normal(log sigma_median, sigma_log_sd), each (4,).

    Noise: its scale over what was estimated, log s ~ normal(0, noise_log_sd).
    """

    mu_mean: NDArray[np.float64]
    mu_sd: NDArray[np.float64]
    sigma_median: NDArray[np.float64]
    sigma_log_sd: NDArray[np.float64]
    noise_log_sd: float


def build_prior(angles: xr.Dataset, frames: xr.Dataset) -> Prior:
    """Build the priors of a campaign from its loads and its clock.

    Parameters
    ----------
    angles
        The `angles` artifact.
    frames
        What `select_frames` says of it.

    Raises
    ------
    Fault
        If no trial has any load.
    """
    load = angles["load_torque"].transpose("trial", "knot").values
    used = frames["used"].values
    largest = np.abs(load[used.any(axis=1)]).max()
    if largest == 0:
        raise Fault("the load is 0 in every trial: parameters cannot be told from such recordings")
    duration = _compute_duration(angles, used)
    k_v = largest / ELASTIC_RAD
    centre = [k_v, k_v * np.sqrt(duration * float(frames["frame_interval"]))]
    centre += [largest * duration / FLOW_RAD]
    return Prior(
        mu_mean=np.array([*np.log(centre), 0.0]),
        mu_sd=np.array(MU_SD),
        sigma_median=np.array(SIGMA_MEDIAN),
        sigma_log_sd=np.full(4, SIGMA_LOG_SD),
        noise_log_sd=NOISE_LOG_SD,
    )


def _compute_duration(angles: xr.Dataset, used: NDArray[np.bool_]) -> float:
    """Median time [s] from the first load to the last used frame."""
    time = angles["time"].transpose("trial", "frame").values
    knots = angles["load_time"].transpose("trial", "knot").values
    load = angles["load_torque"].transpose("trial", "knot").values
    spans = []
    for i in np.flatnonzero(used.any(axis=1) & (load != 0).any(axis=1)):
        onset = max((load[i] != 0).argmax() - 1, 0)
        begin = knots[i, onset] if load[i, 0] == 0 else knots[i, 0]
        spans.append(time[i][used[i]].max() - max(begin, time[i][used[i]].min()))
    return float(np.median(spans))
