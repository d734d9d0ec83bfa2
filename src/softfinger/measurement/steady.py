"""A load log whose plateaus are steady, and whose ramps are straight.

What it reads beside that is its own error.

A log that scatters or drifts while the load rests or runs shows its error by itself. The motion
decides between this model of the log and the other, in which the load follows every reading and
stays until the next.
"""

from collections.abc import Sequence
from itertools import pairwise
from typing import NamedTuple

import numpy as np
import xarray as xr
from numpy.lib.stride_tricks import sliding_window_view
from numpy.typing import NDArray

from softfinger.measurement.decisions import DECISIONS
from softfinger.measurement.frames import compute_frame_interval_array
from softfinger.measurement.open_gaps import find_open_gaps_array
from softfinger.measurement.ramps import straighten_ramps_array, turn_between_rows_array

Array = NDArray[np.float64]


def steady_load_array(time: Array, torque: Array) -> Array:
    """Replace each plateau's readings (knot,) by their mean.

    A plateau is a run of rows without a jump that stays within the share of the load's range that
    counts as a change, but for a few rows on the way to it. Any other run is split into levels and
    ramps, about which its readings scatter.

    >>> steady_load_array(np.arange(7.0), np.array([0.0, 0.0, 1.0, 1.02, 0.98, 0.5, 0.5]))
    array([0. , 0. , 1. , 1. , 1. , 0.5, 0.5])
    """
    change = _find_change(torque)
    steady = torque.copy()
    is_row = np.append(np.diff(time) > 0.0, True)  # of two knots at one time the later one
    jumps = np.flatnonzero(np.abs(np.diff(torque)) > change) + 1
    for run in np.split(np.arange(len(torque)), jumps):
        rows = run[is_row[run]]
        if len(rows) == 0 or np.ptp(torque[run]) == 0.0:
            continue
        steadied, is_steady = torque[rows], np.zeros(len(rows), bool)
        parts = _split_rows(time[rows], torque[rows], change)
        for part in parts:
            steadied[part.first : part.end], is_steady[part.first : part.end] = part.values, True
        for one, other in pairwise(parts):
            _let_meet(time[rows], steadied, one, other, change)
        row = np.minimum(np.searchsorted(rows, run), len(rows) - 1)  # that a knot leads to
        knots = run[is_steady[row]]
        steady[knots] = np.interp(time[knots], time[rows], steadied)
        for one, other in pairwise(parts):
            knot = rows[other.first] - 1  # that leads to the next part
            if time[knot] == time[knot + 1] and _is_step(time[rows], one, other):
                steady[knot] = one.values[-1]
    return steady


class Straight(NamedTuple):
    """Rows about a line.

    They are those from `first` up to `end`, and become `values`.
    """

    first: int
    end: int
    values: Array
    height: float
    slope: float

    def follow(self, time: Array, at: Array) -> Array:
        """Its line at other times (n,)."""
        return self.height + self.slope * (at - time[self.first])


def _is_step(time: Array, one: Straight, other: Straight) -> bool:
    """Whether the load steps from part to part.

    Neither runs by more than a small share of the step from one row to the next.
    """
    if one.end != other.first:
        return False
    rise = abs(other.height - one.follow(time, time[other.first]))
    runs = max(abs(one.slope), abs(other.slope)) * (time[other.first] - time[one.end - 1])
    return DECISIONS.load_change * rise >= runs


def _split_rows(time: Array, torque: Array, change: float) -> list[Straight]:
    """Split readings (row,) into levels and ramps, in their order."""
    parts, found = [(0, len(torque))], []
    while parts:
        first, end = parts.pop()
        t, q = time[first:end], torque[first:end]
        there = np.abs(q - np.median(q)) <= 0.5 * change
        is_level = there.mean() >= 1.0 - DECISIONS.on_the_way
        whole, split = len(q) == len(torque), _find_step(t, q)
        if split is None and is_level and (whole or _scatters(q[there])):
            a, b = _trim_level(q, there)
            level = float(q[a:b][there[a:b]].mean())
            values = np.where(there, level, q)[a:b]
            found.append(Straight(first + a, first + b, values, level, 0.0))
            parts += [(m, n) for m, n in ((first, first + a), (first + b, end)) if m < n]
            continue
        line = _fit_line(t, q)
        if split is None and len(q) >= DECISIONS.ramp_rows and _scatters(q - line):
            slope = (line[-1] - line[0]) / (t[-1] - t[0])
            found.append(Straight(first, end, line, float(line[0]), float(slope)))
            continue
        split = split or _find_bend(t, q)
        if split is not None:
            parts += [(first, first + split), (first + split, end)]
    return sorted(found, key=lambda part: part.first)


def _trim_level(torque: Array, there: NDArray[np.bool_]) -> tuple[int, int]:
    """Leave out rows (row,) at either end that lead to a level.

    A few in a row differ from it by more than they scatter. Where many do, it drifts.
    """
    few = DECISIONS.plateau_rows // 2
    if len(torque) < few:
        return 0, len(torque)
    scatter = np.sqrt(0.5 * np.mean(np.diff(torque[there], append=torque[there][-1]) ** 2))
    scatter = max(scatter, 1e-9 * np.abs(torque).max())  # of rounding
    away = np.abs(sliding_window_view(torque, few).mean(axis=1) - np.median(torque))
    alike = np.flatnonzero(away <= DECISIONS.level_sds * scatter / np.sqrt(few))
    a, b = (int(alike[0]), int(alike[-1]) + few) if alike.size else (0, 0)
    drifts = b - a < (1.0 - DECISIONS.on_the_way) * len(torque)
    return (0, len(torque)) if drifts else (a, b)


def _let_meet(time: Array, steadied: Array, one: Straight, other: Straight, change: float) -> None:
    """Move the turn between neighbouring parts to where their lines cross.

    A level takes in the end of a ramp that it hardly differs from.
    """
    at = time[other.first]
    apart = float(other.height - one.follow(time, at))
    turn = one.slope - other.slope
    if one.end != other.first or abs(apart) > change or turn == 0.0:
        return
    meets = at + apart / turn
    if not time[one.first] <= meets <= time[other.end - 1]:
        return
    rows = slice(one.first, other.end)
    near, t = steadied[rows], time[rows]
    later = np.arange(one.first, other.end) >= other.first
    for line, moved in ((one, later & (t < meets)), (other, ~later & (t > meets))):
        near[moved] = line.follow(time, t[moved])


def _fit_line(time: Array, torque: Array) -> Array:
    away = time - time.mean()
    return torque.mean() + away * (away @ torque) / max(float(away @ away), 1e-300)


def _scatters(left: Array) -> bool:
    """Whether what is left (row,) scatters, by von Neumann's ratio."""
    if len(left) < DECISIONS.plateau_rows:
        return False
    squares = float(np.sum((left - left.mean()) ** 2))
    return float(np.sum(np.diff(left) ** 2)) >= DECISIONS.scatter_ratio * squares


def _find_bend(time: Array, torque: Array) -> int | None:
    """First row of another line; None of too few rows."""
    least = DECISIONS.plateau_rows // 2
    if len(torque) < 2 * least:
        return None
    left = _leave_lines(time, torque)[least - 1 : len(torque) - least]
    right = _leave_lines(-time[::-1], torque[::-1])[::-1][least : len(torque) - least + 1]
    return least + int(np.argmin(left + right))


def _leave_lines(time: Array, torque: Array) -> Array:
    """Squares that a line leaves up to each row (row,)."""
    t, q = time - time.mean(), torque - torque.mean()
    number = np.arange(1, len(t) + 1)
    st, sq, stt, stq, sqq = (np.cumsum(part) for part in (t, q, t * t, t * q, q * q))
    across = stt - st**2 / number
    slope = np.divide(stq - st * sq / number, across, out=np.zeros_like(t), where=across > 0.0)
    return sqq - sq**2 / number - slope**2 * across


def _find_step(time: Array, torque: Array) -> int | None:
    """First row of another level, where two explain more than a line."""
    least, window = DECISIONS.plateau_rows // 2, DECISIONS.step_window
    if len(torque) < 2 * least:
        return None
    before = np.arange(1, len(torque))
    fallen = np.cumsum(torque - torque.mean())[:-1]
    explained = fallen**2 / (before * (len(torque) - before))
    split = int(np.argmax(explained[least - 1 : 1 - least])) + least
    near = slice(max(split - window, 0), split + window)
    line = torque[near] - _fit_line(time[near], torque[near])
    sides = torque[near.start : split], torque[split : near.stop]
    levels = sum(float(np.var(side)) * len(side) for side in sides)
    nats = 0.5 * len(line) * np.log(max(float(line @ line), 1e-300) / max(levels, 1e-300))
    return split if nats >= DECISIONS.step_nats else None


def _find_change(torque: Array) -> float:
    return DECISIONS.load_change * max(np.ptp(torque), np.abs(torque).max(), 1e-300)


def steady_log(angles: xr.Dataset, *, held: bool = False) -> tuple[xr.Dataset, float]:
    """Steady every trial's log, and measure its error.

    With `held` each row of a ramp stays until the next one.

    Returns
    -------
    angles, error
        With `load_time` and `load_torque` (trial, knot) steadied, straight from row to row;
        rms of what was taken away from rows with load, over their load's rms.
    """
    names, dims = ["load_time", "load_torque"], ("trial", "knot")
    time, torque = (angles[name].transpose(*dims).values for name in names)
    steady = np.stack([steady_load_array(*log) for log in zip(time, torque, strict=True)])
    change = np.array([_find_change(log) for log in torque])
    is_row = np.diff(time, axis=1, append=np.inf) > 0.0
    loaded = is_row & (np.abs(steady) > change[:, None])
    away, load = torque[loaded] - steady[loaded], steady[loaded]
    frames = angles["time"].transpose("trial", "frame").values
    interval = compute_frame_interval_array(frames, np.isfinite(frames))
    within = DECISIONS.step_rows * interval
    logs = [
        straighten_ramps_array(*log, within, held=held) for log in zip(time, steady, strict=True)
    ]
    logs = [turn_between_rows_array(*log, find_open_gaps_array(*log, interval)) for log in logs]
    logs = [_step_between_rests(*log, interval) for log in logs]
    parts = zip(names, map(stack_logs, zip(*logs, strict=True)), strict=True)
    steadied = angles.drop_dims("knot").assign({name: (dims, values) for name, values in parts})
    return steadied, float(np.sqrt(away @ away / max(float(load @ load), 1e-300)))


def _step_between_rests(time: Array, torque: Array, interval: float) -> tuple[Array, Array]:
    """Read a line over one wide gap between two rests as a step.

    The campaign's reader has done so with narrow ones. The motion shows when the step came, or that
    it was a line (`mismatch.posed.mend_steps`).
    """
    gaps = find_open_gaps_array(time, torque, interval)
    flat = np.diff(torque, prepend=torque[0], append=np.nan) == 0.0
    wide = np.diff(time)[gaps] > DECISIONS.step_rows * interval
    at = gaps[wide & flat[gaps] & np.append(flat, False)[gaps + 2]] + 1
    return np.insert(time, at, time[at]), np.insert(torque, at, torque[at - 1])


def stack_logs(parts: Sequence[Array]) -> Array:
    """Stack logs (knot,) of trials, the last knot repeated.

    >>> stack_logs([np.array([0.0, 1.0]), np.array([0.0, 1.0, 2.0])])
    array([[0., 1., 1.],
           [0., 1., 2.]])
    """
    return np.stack([np.pad(p, (0, max(map(len, parts)) - len(p)), "edge") for p in parts])
