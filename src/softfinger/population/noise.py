"""Measurement noise without a model of the motion.

Noise of joint j is a stationary Ornstein–Uhlenbeck process seen at the frames: sd σ_j and
correlation ρ_j^(Δt/median interval) across Δt. In quiet zones, away from changes of load, every
motion of the finger is smooth: a quartic in time follows it over a window of at most 200 frames.
What the quartic leaves is noise, and the restricted likelihood (REML) of the window takes account
of the noise that the quartic swallowed:

    −2 log L(σ, ρ) = (n − p) log σ² + log|R| + log|XᵀR⁻¹X| + yᵀ(R⁻¹ − R⁻¹X(XᵀR⁻¹X)⁻¹XᵀR⁻¹)y / σ²

References
----------
Patterson, Thompson (1971), Biometrika 58, 545, doi:10.1093/biomet/58.3.545.
"""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
import xarray as xr
from numba import njit
from numpy.typing import NDArray
from scipy.optimize import minimize_scalar
from scipy.stats import chi2

from softfinger.population.frames import select_frames

WINDOW_FRAMES = 200
LEAST_WINDOW_FRAMES = 25
DEGREE = 4
LEAST_SD = 1e-9  # [rad] far below any camera's noise: a frozen recording has none
DIFFERENT = 9.0  # of −2 log L for each further ρ (3 sd) from which joints do not share one
SHARE_UNSETTLED = 0.2  # of the time between two changes of load, counted from the first


def estimate_noise(angles: xr.Dataset, frames: xr.Dataset | None = None) -> xr.Dataset:
    """Estimate the noise of each joint angle without a model of the motion.

    Parameters
    ----------
    angles
        The `angles` artifact. If its attribute noise_sd_rad is finite, the sd is that number
        and only the autocorrelation is estimated.
    frames
        What `select_frames` says; computed when absent.

    Returns
    -------
    Dataset
        noise_sd (joint) [rad]; noise_autocorrelation (joint), per median frame interval;
        noise_correlation (joint, other_joint), of the innovations; window_count (joint).
        NaN for a joint without a window.
    """
    frames = select_frames(angles) if frames is None else frames
    joints = angles.sizes["joint"]
    declared = float(angles.attrs.get("noise_sd_rad", np.nan))
    windows = [_cut_windows(angles, frames, joint) for joint in range(joints)]
    fits = _share_autocorrelation(
        [_fit_joint(joint_windows, declared) for joint_windows in windows], declared
    )
    correlation = _correlate_joints([fit[2] for fit in fits], [fit[1] for fit in fits])
    coords = {"joint": angles["joint"].values, "other_joint": angles["joint"].values}
    return xr.Dataset(
        {
            "noise_sd": ("joint", np.array([fit[0] for fit in fits])),
            "noise_autocorrelation": ("joint", np.array([fit[1] for fit in fits])),
            "noise_correlation": (("joint", "other_joint"), correlation),
            "window_count": ("joint", np.array([len(fit[2].start) - 1 for fit in fits])),
        },
        coords=coords,
    )


def estimate_residual_noise(
    residual: NDArray[np.float64], time: NDArray[np.float64], interval: float
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Estimate sd and autocorrelation (joint,) of what a model leaves, as if all of it were noise.

    Parameters
    ----------
    residual
        (trial, joint, frame) [rad], NaN where not used.
    time
        (trial, frame) [s].
    interval
        Median frame interval [s].
    """
    sd, rho = np.full(residual.shape[1], np.nan), np.zeros(residual.shape[1])
    for j in range(residual.shape[1]):
        series = []
        for row, moment in zip(residual[:, j], time, strict=True):
            used = np.isfinite(row)
            if used.any():
                gap = np.diff(moment[used], prepend=-np.inf) / interval
                series.append((row[used, None], gap))
        count = sum(len(row) for row, _ in series)
        if not count:
            continue

        def evaluate(logit: float, series: list = series, count: int = count) -> tuple:
            parts = [whiten_array(row, gap, _squash(logit)) for row, gap in series]
            square = sum(float((white**2).sum()) for white, _ in parts)
            variance = max(square / count, LEAST_SD**2)
            return count * np.log(variance) + sum(logdet for _, logdet in parts), variance

        best = _minimise(lambda logit, evaluate=evaluate: evaluate(logit)[0])
        sd[j], rho[j] = np.sqrt(evaluate(best)[1]), _squash(best)
    return sd, rho


def compare_noise(
    angles: xr.Dataset, sd: NDArray[np.float64], autocorrelation: NDArray[np.float64]
) -> float:
    """Test whether quiet windows allow a noise (joint,): p-value of the likelihood ratio."""
    frames = select_frames(angles)
    excess, numbers = 0.0, 0
    for joint in range(angles.sizes["joint"]):
        _, rho, windows = _fit_joint(_cut_windows(angles, frames, joint), np.nan)
        if windows.dof > 0 and np.isfinite(sd[joint]):
            free = _evaluate_reml(windows, rho, np.nan)[0]
            given = _evaluate_reml(windows, float(autocorrelation[joint]), float(sd[joint]))[0]
            excess += max(given - free, 0.0)
            numbers += 2
    return float(chi2.sf(excess, numbers)) if numbers else 1.0


def find_quiet_array(
    time: NDArray[np.float64], load_time: NDArray[np.float64], load_torque: NDArray[np.float64]
) -> NDArray[np.bool_]:
    """Mark the times (n,) that lie well after the last change of load and before the next one.

    A change is a knot at which the load jumps, or its slope turns, by more than 5 % of its range
    (a slope counts by what it moves in the time to the next knot).

    >>> find_quiet_array(np.arange(6.0), np.array([0.0, 5.0]), np.array([1.0, 1.0]))
    array([False, False,  True,  True,  True, False])
    """
    changes = find_load_changes_array(load_time, load_torque)
    edges = np.concatenate([[-np.inf], changes, [np.inf]])
    phase = np.searchsorted(edges, time, side="right") - 1
    begin = np.maximum(edges[phase], time[0])
    end = np.minimum(edges[phase + 1], time[-1])
    loaded = edges[phase] > -np.inf
    return (time > begin + np.where(loaded, SHARE_UNSETTLED, 0.0) * (end - begin)) & (time < end)


def find_load_changes_array(
    load_time: NDArray[np.float64], load_torque: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Find the times [s] at which the load or its slope changes noticeably.

    >>> find_load_changes_array(np.array([0.0, 4.0, 4.0, 8.0]), np.array([0.0, 0.0, 1.0, 1.0]))
    array([4.])
    """
    threshold = 0.05 * max(np.ptp(load_torque), np.abs(load_torque).max())
    if threshold == 0:
        return np.empty(0)
    step = np.diff(load_time)
    rise = np.diff(load_torque)
    slope = np.divide(rise, step, out=np.zeros_like(rise), where=step > 0)
    span = np.append(step, 0.0)
    before, after = np.insert(slope, 0, 0.0), np.append(slope, 0.0)
    turn = np.abs(after - before) * np.maximum(span, np.insert(step, 0, 0.0))
    jump = np.concatenate([[load_torque[0]], np.where(step > 0, 0.0, rise)])
    return np.unique(load_time[(turn > threshold) | (np.abs(jump) > threshold)])


def whiten_array(
    rows: NDArray[np.float64], gap: NDArray[np.float64], autocorrelation: float
) -> tuple[NDArray[np.float64], float]:
    """Whiten the rows (n, k) of a series with unit-sd AR(1) noise; W with WᵀW = R⁻¹.

    Row i becomes (row_i − ρ^g_i row_{i−1}) / √(1 − ρ^{2 g_i}); the first, and any with an infinite
    gap, stays as it is.

    Parameters
    ----------
    rows
        (n, k).
    gap
        (n,) time since the row before, in units over which the correlation is `autocorrelation`;
        the first is not read.
    autocorrelation
        ρ in [0, 1).

    Returns
    -------
    whitened, logdet : (n, k) and log|R|.

    Examples
    --------
    >>> white, logdet = whiten_array(np.array([[1.0], [1.0]]), np.array([np.inf, 1.0]), 0.6)
    >>> white.ravel(), round(logdet, 6)
    (array([1. , 0.5]), -0.446287)
    """
    rows, gap = np.ascontiguousarray(rows, float), np.asarray(gap, float)
    white = np.empty_like(rows)
    return white, _whiten(rows, gap, float(autocorrelation), white)


@njit(cache=True)
def _whiten(rows: NDArray, gap: NDArray, rho: float, white: NDArray) -> float:
    logdet = 0.0
    white[0] = rows[0]
    for i in range(1, rows.shape[0]):
        carried = rho ** gap[i]
        spread = np.sqrt(1.0 - carried * carried)
        logdet += 2.0 * np.log(spread)
        for k in range(rows.shape[1]):
            white[i, k] = (rows[i, k] - carried * rows[i - 1, k]) / spread
    return logdet


@njit(cache=True)
def _profile_windows(
    rho: float, rows: NDArray, gap: NDArray, start: NDArray, residual: NDArray
) -> tuple[NDArray, float]:
    """RSS of each window and Σ (log|R| + log|XᵀR⁻¹X|); fills `residual` (n,), whitened."""
    rss, logdet = np.zeros(start.size - 1), 0.0
    for window in range(start.size - 1):
        part = slice(start[window], start[window + 1])
        white = np.empty((start[window + 1] - start[window], rows.shape[1]))
        logdet += _whiten(rows[part], gap[part], rho, white)
        design, value = np.ascontiguousarray(white[:, :-1]), np.ascontiguousarray(white[:, -1])
        gram = design.T @ design
        left = value - design @ np.linalg.solve(gram, design.T @ value)
        logdet += np.log(np.linalg.det(gram))
        residual[part] = left
        rss[window] = left @ left
    return rss, logdet


class _Windows(NamedTuple):
    """Quiet windows of a joint, end to end: rows (n, DEGREE + 2) hold powers and the angle."""

    rows: NDArray
    gap: NDArray
    start: NDArray
    place: NDArray  # (n,) trial · frames + frame, to match joints with each other

    @property
    def dof(self) -> int:
        return len(self.rows) - (DEGREE + 1) * (len(self.start) - 1)

    def keep(self, chosen: NDArray[np.bool_]) -> "_Windows":
        sizes = np.diff(self.start)
        row = np.repeat(chosen, sizes)
        start = np.concatenate([[0], np.cumsum(sizes[chosen])])
        return _Windows(self.rows[row], self.gap[row], start, self.place[row])


def _cut_windows(angles: xr.Dataset, frames: xr.Dataset, joint: int) -> _Windows:
    time = angles["time"].transpose("trial", "frame").values
    angle = angles["joint_angle"].transpose("trial", "joint", "frame").values[:, joint]
    angle = angle / frames["frame_scale"].values
    interval = float(frames["frame_interval"])
    rows, gaps, sizes, places = [], [], [], []
    for trial in np.flatnonzero(frames["present"].values[:, joint]):
        index = np.flatnonzero(frames["used"].values[trial])
        load = (angles[name].values[trial] for name in ("load_time", "load_torque"))
        for part in _split_quiet(index, find_quiet_array(time[trial, index], *load)):
            t = time[trial, part]
            position = 2 * (t - t[0]) / (t[-1] - t[0]) - 1
            rows.append(np.column_stack([np.vander(position, DEGREE + 1), angle[trial, part]]))
            gaps.append(np.diff(t, prepend=-np.inf) / interval)
            sizes.append(len(part))
            places.append(trial * time.shape[1] + part)
    if not rows:
        return _Windows(np.empty((0, DEGREE + 2)), np.empty(0), np.zeros(1, int), np.empty(0, int))
    start = np.concatenate([[0], np.cumsum(sizes)])
    return _Windows(np.concatenate(rows), np.concatenate(gaps), start, np.concatenate(places))


def _split_quiet(index: NDArray, quiet: NDArray[np.bool_]) -> list[NDArray]:
    """Split the quiet runs of used frames into even windows of at most WINDOW_FRAMES."""
    runs = np.split(index, np.flatnonzero(np.diff(quiet)) + 1)
    first = bool(quiet[0])
    quiet_runs = runs[0 if first else 1 :: 2]
    windows = []
    for run in quiet_runs:
        windows += np.array_split(run, -(-len(run) // WINDOW_FRAMES))
    return [window for window in windows if len(window) >= LEAST_WINDOW_FRAMES]


def _fit_joint(windows: _Windows, declared: float) -> tuple[float, float, _Windows]:
    """Fit σ and ρ, then once more in the calm windows: not three times as lively as most."""
    if windows.dof <= 0:
        return declared, np.nan, windows
    sd, rho = _maximise_reml(windows, declared)
    rss, _ = _profile_windows(rho, *windows[:3], np.empty(len(windows.rows)))
    variance = rss / (np.diff(windows.start) - DEGREE - 1)
    calm = windows.keep(variance <= 3 * np.median(variance))
    sd, rho = _maximise_reml(calm, declared)
    return sd, rho, calm


def _share_autocorrelation(
    fits: list[tuple[float, float, _Windows]], declared: float
) -> list[tuple[float, float, _Windows]]:
    """Let joints share one ρ, as what one camera sees would, unless the windows say otherwise."""
    known = [fit[2] for fit in fits if fit[2].dof > 0]
    if len(known) < 2:
        return fits

    def deviance(logit: float) -> float:
        return sum(_evaluate_reml(windows, _squash(logit), declared)[0] for windows in known)

    rho = _squash(_minimise(deviance))
    shared = [
        (_evaluate_reml(fit[2], rho, declared)[1], rho, fit[2]) if fit[2].dof > 0 else fit
        for fit in fits
    ]
    apart, together = (
        sum(_evaluate_reml(fit[2], fit[1], declared)[0] for fit in some if fit[2].dof > 0)
        for some in (fits, shared)
    )
    return fits if together - apart > DIFFERENT * (len(known) - 1) else shared


def _maximise_reml(windows: _Windows, declared: float) -> tuple[float, float]:
    rho = _squash(_minimise(lambda logit: _evaluate_reml(windows, _squash(logit), declared)[0]))
    return _evaluate_reml(windows, rho, declared)[1], rho


def _evaluate_reml(windows: _Windows, rho: float, declared: float) -> tuple[float, float]:
    """−2 log L at ρ and the best σ, and that σ."""
    rss, logdet = _profile_windows(rho, *windows[:3], np.empty(len(windows.rows)))
    variance = declared**2 if np.isfinite(declared) else rss.sum() / windows.dof
    variance = max(variance, LEAST_SD**2)
    return windows.dof * np.log(variance) + logdet + rss.sum() / variance, float(np.sqrt(variance))


def _minimise(deviance: Callable[[float], float]) -> float:
    return float(
        minimize_scalar(deviance, bounds=(-7.0, 7.6), method="bounded", options={"xatol": 1e-3}).x
    )


def _squash(logit: float) -> float:
    return 1.0 / (1.0 + np.exp(-logit))


def _correlate_joints(windows: list[_Windows], autocorrelation: list[float]) -> NDArray:
    """Correlation of the whitened leftovers of two joints over the calm frames that they share."""
    leftover = []
    for part, rho in zip(windows, autocorrelation, strict=True):
        residual = np.empty(len(part.rows))
        if np.isfinite(rho):
            _profile_windows(rho, *part[:3], residual)
        leftover.append(residual)
    correlation = np.eye(len(windows))
    for a in range(len(windows)):
        for b in range(a):
            _, i, j = np.intersect1d(windows[a].place, windows[b].place, return_indices=True)
            x, y = leftover[a][i], leftover[b][j]
            scale = np.sqrt((x @ x) * (y @ y))
            correlation[a, b] = correlation[b, a] = x @ y / scale if scale > 0 else np.nan
    return correlation
