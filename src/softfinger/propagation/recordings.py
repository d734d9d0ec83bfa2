"""Recorded angles on the time grid of the bands."""

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from softfinger.propagation.new_trials import (
    QUANTILES,
    order_samples_array,
    take_quantiles_array,
)
from softfinger.propagation.scores import mean_over_trials

LONGEST_GAP = 3.0  # median intervals across which a recording is interpolated


def build_time_grid(angles: xr.Dataset, most: int) -> NDArray[np.float64]:
    """Build an even grid of times.

    Returns
    -------
    (time,) [s]
    """
    duration = float(angles["time"].max())
    frames = int(duration / find_frame_interval(angles) + 0.5) + 1
    return np.linspace(0.0, duration, min(most, frames))


def find_frame_interval(angles: xr.Dataset) -> float:
    """Find the median frame interval [s]."""
    interval = np.diff(angles["time"].transpose("trial", "frame").to_numpy(), axis=1)
    return float(np.median(interval[interval > 0]))


def extract_recordings(angles: xr.Dataset) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Extract frame times and joint angles.

    They are (trial, frame) [s] and (trial, joint, frame) [rad]; bad ones are NaN.
    """
    time = angles["time"].transpose("trial", "frame").to_numpy()
    good = angles["angle_flag"].transpose("trial", "joint", "frame").to_numpy() == 0
    angle = angles["joint_angle"].transpose("trial", "joint", "frame").to_numpy()
    return time, np.where(good & np.isfinite(time)[:, None], angle, np.nan)


def resample_recordings_array(
    time: NDArray[np.float64], angle: NDArray[np.float64], grid: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Interpolate recordings to a grid.

    From (trial, joint, frame) to (trial, joint, time).

    NaN before the first and after the last good frame, and inside gaps of more than three median
    intervals between good frames.

    Examples
    --------
    >>> time = np.array([[0.0, 1.0, 2.0, 9.0]])
    >>> resample_recordings_array(time, 2 * time[:, None], np.array([0.5, 5.0, 9.0]))
    array([[[ 1., nan, 18.]]])
    """
    out = np.full((*angle.shape[:2], grid.size), np.nan)
    for trial, joint in np.ndindex(*angle.shape[:2]):
        good = np.isfinite(angle[trial, joint])
        t = time[trial, good]
        if t.size < 2:
            continue
        gap = np.diff(t)
        after = np.clip(np.searchsorted(t, grid, side="left"), 1, t.size - 1)
        usable = gap[after - 1] <= LONGEST_GAP * np.median(gap)
        exact = (t[after] == grid) | (t[after - 1] == grid)
        usable = (usable | exact) & (grid >= t[0]) & (grid <= t[-1])
        value = np.interp(grid, t, angle[trial, joint, good])
        out[trial, joint, usable] = value[usable]
    return out


def average_recordings(
    time: NDArray[np.float64],
    angle: NDArray[np.float64],
    grid: NDArray[np.float64],
) -> xr.Dataset:
    """Summarise the recordings of a protocol.

    Returns
    -------
    Dataset
        recorded_mean, recorded_sd [rad], recorded_n (joint, time) and recorded_quantile (joint,
        time, quantile) [rad]; NaN where no trial was recorded, the sd also where only one was.
    """
    values = np.sort(resample_recordings_array(time, angle, grid), axis=0)  # NaN come last
    count = np.isfinite(values).sum(axis=0)
    mean = mean_over_trials(values)
    square = mean_over_trials((values - mean) ** 2)
    several = count > 1
    unbiased = np.where(several, count / np.maximum(count - 1, 1), np.nan)
    quantile = np.full((*count.shape, len(QUANTILES)), np.nan)
    for n in np.unique(count[count > 0]):
        ordered, order = order_samples_array(values[:n, count == n].T)
        even = np.full(n, 1 / n)
        quantile[count == n] = take_quantiles_array(ordered, order, even, np.array(QUANTILES))
    dims = ("joint", "time")
    return xr.Dataset(
        {
            "recorded_mean": (dims, mean),
            "recorded_sd": (dims, np.sqrt(square * unbiased)),
            "recorded_n": (dims, count),
            "recorded_quantile": ((*dims, "quantile"), quantile),
        }
    )
