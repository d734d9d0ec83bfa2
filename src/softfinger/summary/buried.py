"""Residual that trials share, before and after repair."""

import numpy as np
import xarray as xr
from numpy.typing import NDArray

WINDOWS = 24


def average_residual(repair: xr.Dataset) -> xr.Dataset:
    """Average all trials' residuals in windows of time.

    Returns
    -------
    Dataset
        mean_residual (model, joint, window), in units of its own standard deviation under noise
        alone, NaN where there is no bin; window [s] is the middle of each; trials ().
    """
    time = repair["time"].transpose("trial", "bin").values
    off = (repair["recorded_angle"] - repair["fitted_angle"]) / repair["bin_noise_sd"]
    edges = np.linspace(0.0, np.nanmax(time) * (1 + 1e-9), WINDOWS + 1)
    dims = ("model", "joint", "trial", "bin")
    mean = np.array(
        [[_average(time, own, edges) for own in model] for model in off.transpose(*dims).values]
    )
    coords = {name: repair[name].values for name in ("model", "joint")}
    coords["window"] = 0.5 * (edges[1:] + edges[:-1])
    found = xr.Dataset({"mean_residual": (("model", "joint", "window"), mean)}, coords)
    return found.assign(trials=((), repair.sizes["trial"])).assign_attrs(repair.attrs)


def _average(time: NDArray, off: NDArray, edges: NDArray) -> NDArray[np.float64]:
    known = np.isfinite(off) & np.isfinite(time)
    window = np.digitize(time[known], edges) - 1
    count = np.bincount(window, minlength=WINDOWS)
    total = np.bincount(window, off[known], minlength=WINDOWS)
    return np.where(count > 0, total / np.sqrt(np.maximum(count, 1)), np.nan)
