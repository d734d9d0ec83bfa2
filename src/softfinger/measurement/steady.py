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
    counts as a change, but for a few rows on the way to it. A run of several plateaus is
    split where its level changes most.

    >>> steady_load_array(np.array([0.0, 0.0, 1.0, 1.02, 0.98, 0.5, 0.5]))
    array([0. , 0. , 1. , 1. , 1. , 0.5, 0.5])
    """
    change = _find_change(torque)
    steady = torque.copy()
    jumps = np.flatnonzero(np.abs(np.diff(torque)) > change) + 1
    runs = [(run, False) for run in np.split(np.arange(len(torque)), jumps)]
    while runs:
        run, is_part = runs.pop()
        away = np.abs(torque[run] - np.median(torque[run])) > 0.5 * change
        there = run[~away]
        first = _find_split(torque[run])
        if away.mean() > DECISIONS.on_the_way or _is_step(torque[run], first):
            runs += [(part, True) for part in np.split(run, [first])]
        elif 0.0 < np.ptp(torque[there]) <= change and not (is_part and _may_run(torque[there])):
            steady[there] = torque[there].mean()
    return steady


def _find_split(torque: NDArray[np.float64]) -> int:
    """First row (knot,) after the change of level that explains most of the squares."""
    before = np.arange(1, len(torque))
    fallen = np.cumsum(torque - torque.mean())[:-1]
    explained = fallen**2 / (before * (len(torque) - before))
    return int(before[np.argmax(explained)]) if len(before) else 0


def _is_step(torque: NDArray[np.float64], first: int) -> bool:
    """Whether readings (knot,) step at a row, near which a line leaves more of them."""
    near = [torque[max(first - DECISIONS.step_window, 0) : first]]
    near += [torque[first : first + DECISIONS.step_window]]
    sides = [_drop_held(side) for side in near]
    if min(len(side) for side in sides) < DECISIONS.plateau_rows:
        return False
    both = np.concatenate(sides)
    line = np.polynomial.Polynomial.fit(np.arange(len(both)), both, 1)
    left = np.sum((both - line(np.arange(len(both)))) ** 2)
    return float(sum(np.var(side) * len(side) for side in sides)) < DECISIONS.step_leaves * left


def _may_run(torque: NDArray[np.float64]) -> bool:
    """Whether readings (knot,) may be a ramp's, by von Neumann's ratio."""
    torque = _drop_held(torque)
    if len(torque) < DECISIONS.plateau_rows:
        return True
    return float(np.mean(np.diff(torque) ** 2) / np.var(torque)) < DECISIONS.scatter_ratio


def _drop_held(torque: NDArray[np.float64]) -> NDArray[np.float64]:
    return torque[np.flatnonzero(np.diff(torque, prepend=np.nan))]


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
