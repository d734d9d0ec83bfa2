"""A load log whose plateaus are steady.

What it reads beside that is its own error.

A log that scatters or drifts while the load rests shows its error by itself. The motion decides
between this model of the log and the other, in which the load follows every reading.
"""

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from softfinger.measurement.decisions import DECISIONS


def steady_load_array(torque: NDArray[np.float64]) -> NDArray[np.float64]:
    """Replace each plateau's readings (knot,) by their mean.

    A plateau is a run of rows without a jump that stays within the share of the load's range that
    counts as a change, but for a few rows on the way to it.

    >>> steady_load_array(np.array([0.0, 0.0, 1.0, 1.02, 0.98, 0.5, 0.5]))
    array([0. , 0. , 1. , 1. , 1. , 0.5, 0.5])
    """
    change = _find_change(torque)
    steady = torque.copy()
    for run in np.split(
        np.arange(len(torque)), np.flatnonzero(np.abs(np.diff(torque)) > change) + 1
    ):
        away = np.abs(torque[run] - np.median(torque[run])) > 0.5 * change
        if away.mean() > DECISIONS.on_the_way:
            continue
        there = run[~away]
        if 0.0 < np.ptp(torque[there]) <= change:
            steady[there] = torque[there].mean()
    return steady


def _find_change(torque: NDArray[np.float64]) -> float:
    return DECISIONS.load_change * max(np.ptp(torque), np.abs(torque).max(), 1e-300)


def steady_log(angles: xr.Dataset) -> tuple[xr.Dataset, float]:
    """Steady every trial's log, and measure its error.

    Returns
    -------
    angles, error
        With `load_torque` (trial, knot) steadied; relative rms of what was taken away, where there
        is load; 0 where every plateau was steady.
    """
    logged = angles["load_torque"].transpose("trial", "knot")
    steady = np.stack([steady_load_array(torque) for torque in logged.values])
    loaded = np.abs(steady) > np.array([[_find_change(torque)] for torque in logged.values])
    if not loaded.any():
        return angles, 0.0
    error = float(np.sqrt(np.mean((logged.values[loaded] / steady[loaded] - 1.0) ** 2)))
    return angles.assign(load_torque=(logged.dims, steady)), error
