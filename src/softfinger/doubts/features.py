"""Simple features of every trial, for doubts."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from softfinger.doubts.noise import measure_noise, measure_resolution
from softfinger.doubts.response import (
    Response,
    choose_times,
    compute_terms,
    fit_response,
)

Array = NDArray[np.float64]
MOST_FRAMES, MOST_KNOTS = 240, 300
MISSING, STALE, JUMP = 1, 2, 4  # bits of angle_flag
SAMPLED = 20  # rows of a log that was sampled; one of fewer may name its changes only
RELEASES = 8  # times after a log's end at which the load may have been taken off
# Shifts [s] of the recording against its load that are tried.
SHIFTS = (0.3, 0.6, 1.0, 1.5, 2.0, 3.0, 5.0, 10.0)


@dataclass(frozen=True)
class TrialFeatures:
    """One trial's arrays and its fitted response.

    They are without padding; thinned arrays are added.
    """

    name: str
    time: Array
    angle: Array  # (joint, frame), NaN = missing
    load_time: Array
    load: Array
    stale: float  # share of frames that repeat the one before
    rest: Array  # (joint,) [rad] before the load acts; NaN where that was not recorded
    response: Response
    noise: Array  # (joint,) [rad]
    resolution: Array  # (joint,) [rad], the step to which the angles are rounded
    correlation: Array  # (joint, joint) of the noise
    moved: Array  # (joint,) [rad] from rest to the farthest, by the response
    gain: Array  # (joint,) [rad per load] response after the campaign's usual duration
    unexplained: float  # rms of what no such response explains, of the motion's rms
    shift: float  # [s] of the recording against the load that explains most
    shifted: float  # unexplained at that shift
    pace: float  # [s] in which the chain's response, at that shift, reaches half of it
    log_end: float  # [s] of the log's last row
    log_interval: float  # [s] between its rows; infinite where they are few
    released: float  # unexplained if the load was taken off after the log's end; NaN: no such time

    @property
    def interval(self) -> float:
        """Median frame interval [s]."""
        return float(np.median(np.diff(self.time)))

    @property
    def span(self) -> float:
        """Time [s] from the first to the last frame."""
        return float(self.time[-1] - self.time[0])

    @property
    def loaded_at(self) -> float:
        """Time [s] of the first load, or NaN."""
        return find_first_load(self.load_time, self.load)

    @property
    def largest_load(self) -> float:
        """Largest |load| that acts while the recording runs."""
        inside = (self.load_time >= self.time[0]) & (self.load_time <= self.time[-1])
        at = np.interp(self.time, self.load_time, self.load, left=0.0)
        return float(max(np.abs(at).max(), np.abs(self.load[inside]).max(initial=0.0)))


def describe_trials(angles: xr.Dataset) -> list[TrialFeatures]:
    """Features of every trial in the `angles` artifact."""
    arrays = [_cut(angles.isel(trial=k)) for k in range(angles.sizes["trial"])]
    spans = [time[-1] - time[0] for time, *_ in arrays]
    horizon = float(np.median(spans))
    names = angles["trial"].values.astype(str)
    return [_describe(str(n), *a, horizon) for n, a in zip(names, arrays, strict=True)]


def _cut(one: xr.Dataset) -> tuple[Array, Array, Array, Array, float, NDArray[np.bool_]]:
    """Frames, angles, load, stale share and jumps of a trial.

    The padding is cut off; the share is that of stale frames.
    """
    time = one["time"].to_numpy()
    inside = np.isfinite(time)
    angle = one["joint_angle"].transpose("joint", "frame").to_numpy()[:, inside]
    flag = one["angle_flag"].transpose("joint", "frame").to_numpy()[:, inside]
    angle = np.where(flag & MISSING, np.nan, angle)
    load_time, load = one["load_time"].to_numpy(), one["load_torque"].to_numpy()
    stale = float((flag & STALE > 0).any(axis=0).mean())
    return time[inside], angle, load_time, load, stale, flag & JUMP > 0


def _describe(
    name: str,
    time: Array,
    angle: Array,
    load_time: Array,
    load: Array,
    stale: float,
    jumps: NDArray[np.bool_],
    horizon: float,
) -> TrialFeatures:
    chosen = thin(time, load_time)
    few, seen = time[chosen], np.where(jumps[:, chosen], np.nan, angle[:, chosen])
    rows = np.unique(load_time)
    knots = np.unique(np.linspace(0, load_time.size - 1, MOST_KNOTS).astype(int))
    load_time, load = load_time[knots], load[knots]
    times = choose_times(float(time[-1] - time[0]), float(np.median(np.diff(time))))

    def explain(shift: float) -> tuple[Response, float]:
        terms = compute_terms(few - shift, load_time, load, times)
        response = fit_response(terms, seen, times)
        return response, measure_unexplained(response, seen)

    response, unexplained = explain(0.0)
    shift = _find_shift(explain, unexplained, float(time[-1] - time[0]))
    best, shifted = explain(shift)
    fitted = seen - response.residual
    reached = _reach(response, horizon)
    noise, correlation = measure_noise(angle)
    return TrialFeatures(
        name=name,
        time=time,
        angle=angle,
        load_time=load_time,
        load=load,
        stale=stale,
        rest=measure_rest(time, angle, find_first_load(load_time, load)),
        response=response,
        noise=noise,
        resolution=measure_resolution(angle),
        correlation=correlation,
        moved=_find_farthest(fitted - response.rest[:, None]),
        gain=reached,
        unexplained=unexplained,
        shift=shift,
        shifted=shifted,
        pace=_find_pace(best, horizon),
        log_end=float(rows[-1]),
        log_interval=float(np.median(np.diff(rows))) if rows.size >= SAMPLED else np.inf,
        released=_try_release(few, seen, load_time, load, times),
    )


def thin(time: Array, load_time: Array) -> NDArray[np.intp]:
    """Indices of at most some hundred frames.

    They are even in number, and contain those after load changes.
    """
    even = np.linspace(0, time.size - 1, MOST_FRAMES // 2).astype(int)
    changes = np.unique(load_time)
    changes = changes[:: max(1, changes.size // 12)]
    first = np.searchsorted(time, changes)[:, None] + np.array([-2, -1, 0, 1, 2, 3, 5, 8, 12])
    return np.unique(np.concatenate([even, first.ravel()]).clip(0, time.size - 1))


def find_first_load(load_time: Array, load: Array) -> float:
    """Time [s] of the first nonzero load.

    NaN where there is none.

    >>> find_first_load(np.array([0.0, 1.0, 1.0, 4.0]), np.array([0.0, 0.0, 2.0, 2.0]))
    1.0
    """
    loaded = np.flatnonzero(load)
    if not loaded.size:
        return float("nan")
    return float(load_time[max(loaded[0] - 1, 0)])


def measure_rest(time: Array, angle: Array, loaded_at: float) -> Array:
    """Median angle (joint,) before the load, or NaN."""
    before = angle[:, time <= loaded_at]
    rest = np.full(len(angle), np.nan)
    for joint, values in enumerate(before):
        if np.isfinite(values).any():
            rest[joint] = np.nanmedian(values)
    return rest


def measure_unexplained(response: Response, angle: Array) -> float:
    """Rms of residual over motion, joints pooled."""
    motion = angle - np.nanmean(angle, axis=1, keepdims=True)
    left = np.nansum(response.residual**2)
    return float(np.sqrt(left / max(np.nansum(motion**2), 1e-300)))


def _find_shift(
    explain: Callable[[float], tuple[Response, float]], unexplained: float, span: float
) -> float:
    """The shift that explains most.

    It is 0 where none explains more than no shift.
    """
    tried = [sign * s for s in SHIFTS if s < 0.5 * span for sign in (1, -1)]
    left = {shift: explain(shift)[1] for shift in tried} | {0.0: unexplained}
    return min(left, key=lambda shift: left[shift])


def _try_release(time: Array, angle: Array, load_time: Array, load: Array, times: Array) -> float:
    """Unexplained if the load went to zero after its log.

    The best of some times; NaN where the log lasts as long as the recording.
    """
    after = time[time > load_time[-1]]
    if after.size < 2 * RELEASES or load[-1] == 0.0:
        return float("nan")
    left = []
    for at in np.linspace(load_time[-1], after[-RELEASES // 2], RELEASES):
        terms = compute_terms(
            time, np.append(load_time, [at, at]), np.append(load, [load[-1], 0.0]), times
        )
        left.append(measure_unexplained(fit_response(terms, angle, times), angle))
    return min(left)


def _find_farthest(moved: Array) -> Array:
    place = np.nanargmax(np.abs(np.nan_to_num(moved)), axis=1)
    return np.nan_to_num(moved)[np.arange(len(moved)), place]


def _reach(response: Response, after: float) -> Array:
    """Response (joint,) to a unit step after some time.

    Flow counts over the same time.
    """
    finite = response.times[1:-1]
    risen = np.concatenate([[1.0], -np.expm1(-after / finite), [1.0]])
    return response.amplitude @ risen


def _find_pace(response: Response, horizon: float) -> float:
    total = np.abs(response.amplitude).sum(axis=0)
    finite = response.times[1:-1]
    grid = np.geomspace(1e-4 * horizon, horizon, 200)
    risen = np.column_stack(
        [np.ones(grid.size), -np.expm1(-grid[:, None] / finite), grid / horizon]
    )
    curve = risen @ total
    return float(grid[min(int(np.searchsorted(curve, 0.5 * curve[-1])), grid.size - 1)])
