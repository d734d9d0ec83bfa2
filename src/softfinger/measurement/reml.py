"""Restricted likelihood of AR(1) noise in quiet windows.

The windows may contain any smooth motion.

In quiet zones, away from changes of load, every motion of the finger is smooth: a quartic in time
follows it over a window of at most 200 frames. What the quartic leaves is noise, and the restricted
likelihood (REML) of the window takes account of the noise that the quartic swallowed:

    −2 log L(σ, ρ) = (n − p) log σ² + log|R| + log|XᵀR⁻¹X| + yᵀ(R⁻¹ − R⁻¹X(XᵀR⁻¹X)⁻¹XᵀR⁻¹)y / σ²

Windows cannot separate noise that outlasts them from a drift without end. So how long it lasts,
τ = −1/log ρ frames, has an exponential prior with a mean of a quarter of a window.

References
----------
Patterson, Thompson (1971), Biometrika 58, 545, doi:10.1093/biomet/58.3.545.
"""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
import xarray as xr
from numpy.typing import NDArray
from scipy.optimize import minimize_scalar
from scipy.special import expit

from softfinger.compiled import compiled
from softfinger.measurement.decisions import DECISIONS
from softfinger.measurement.priors import PRIORS
from softfinger.measurement.quiet import find_quiet_array

LEAST_SD = 1e-9  # [rad] far below any camera's noise: a frozen recording has none


def whiten_array(
    rows: NDArray[np.float64], gap: NDArray[np.float64], autocorrelation: float
) -> tuple[NDArray[np.float64], float]:
    """Whiten the rows of a series with AR(1) noise.

    The rows are (n, k), the noise has unit sd; W with WᵀW = R⁻¹.

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


@compiled
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


@compiled
def profile_windows(
    rho: float, rows: NDArray, gap: NDArray, start: NDArray, residual: NDArray
) -> tuple[NDArray, float]:
    """RSS of each window, and Σ (log|R| + log|XᵀR⁻¹X|).

    It fills `residual` (n,), whitened.
    """
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


class Windows(NamedTuple):
    """Quiet windows of a joint, end to end.

    Rows (n, degree + 2) contain powers and the angle.
    """

    rows: NDArray
    gap: NDArray
    start: NDArray
    place: NDArray  # (n,) trial · frames + frame, to match joints with each other

    @property
    def dof(self) -> int:
        """Rows that the quartics leave free."""
        return len(self.rows) - (PRIORS.degree + 1) * (len(self.start) - 1)

    def keep(self, chosen: NDArray[np.bool_]) -> "Windows":
        """Keep the chosen windows (window,)."""
        sizes = np.diff(self.start)
        row = np.repeat(chosen, sizes)
        start = np.concatenate([[0], np.cumsum(sizes[chosen])])
        return Windows(self.rows[row], self.gap[row], start, self.place[row])


def cut_windows(angles: xr.Dataset, frames: xr.Dataset, joint: int) -> Windows:
    """Cut the quiet frames of a joint into windows.

    The frames are those of all trials.
    """
    time = angles["time"].transpose("trial", "frame").values
    angle = angles["joint_angle"].transpose("trial", "joint", "frame").values[:, joint]
    angle = angle / frames["frame_scale"].values
    if "noise_factor" in frames:
        angle = angle / frames["noise_factor"].values[:, joint]
    interval = float(frames["frame_interval"])
    rows, gaps, sizes, places = [], [], [], []
    for trial in np.flatnonzero(frames["present"].values[:, joint]):
        index = np.flatnonzero(frames["used"].values[trial])
        load = (angles[name].values[trial] for name in ("load_time", "load_torque"))
        for part in _split_quiet(index, find_quiet_array(time[trial, index], *load)):
            t = time[trial, part]
            position = 2 * (t - t[0]) / (t[-1] - t[0]) - 1
            powers = np.vander(position, PRIORS.degree + 1)
            rows.append(np.column_stack([powers, angle[trial, part]]))
            gaps.append(np.diff(t, prepend=-np.inf) / interval)
            sizes.append(len(part))
            places.append(trial * time.shape[1] + part)
    if not rows:
        none = np.empty((0, PRIORS.degree + 2))
        return Windows(none, np.empty(0), np.zeros(1, int), np.empty(0, int))
    start = np.concatenate([[0], np.cumsum(sizes)])
    return Windows(np.concatenate(rows), np.concatenate(gaps), start, np.concatenate(places))


def _split_quiet(index: NDArray, quiet: NDArray[np.bool_]) -> list[NDArray]:
    """Split quiet runs of used frames into even windows.

    Each has at most `window_frames`.
    """
    runs = np.split(index, np.flatnonzero(np.diff(quiet)) + 1)
    first = bool(quiet[0])
    quiet_runs = runs[0 if first else 1 :: 2]
    windows = []
    for run in quiet_runs:
        windows += np.array_split(run, -(-len(run) // DECISIONS.window_frames))
    return [window for window in windows if len(window) >= DECISIONS.least_window_frames]


def fit_joint(windows: Windows, declared: float) -> tuple[float, float, Windows]:
    """Fit σ and ρ, then again in calm windows.

    Calm windows are not three times as lively as most.
    """
    if windows.dof <= 0:
        return declared, np.nan, windows
    sd, rho = _maximise_reml(windows, declared)
    rss, _ = profile_windows(rho, *windows[:3], np.empty(len(windows.rows)))
    variance = rss / (np.diff(windows.start) - PRIORS.degree - 1)
    calm = windows.keep(variance <= DECISIONS.lively * np.median(variance))
    sd, rho = _maximise_reml(calm, declared)
    return sd, rho, calm


def _maximise_reml(windows: Windows, declared: float) -> tuple[float, float]:
    rho = find_autocorrelation([windows], declared)
    return evaluate_reml(windows, rho, declared)[1], rho


def find_autocorrelation(windows: list[Windows], declared: float) -> float:
    """Find the most probable ρ that all joints share.

    Each joint has its own best σ.
    """
    frames = PRIORS.lasting_windows * DECISIONS.window_frames

    def deviance(logit: float) -> float:
        rho = expit(logit)
        lasting = -2.0 / np.log(rho) / frames
        return lasting + sum(evaluate_reml(part, rho, declared)[0] for part in windows)

    return float(expit(minimise_deviance(deviance)))


def evaluate_reml(windows: Windows, rho: float, declared: float) -> tuple[float, float]:
    """−2 log L at ρ, and its best σ."""
    rss, logdet = profile_windows(rho, *windows[:3], np.empty(len(windows.rows)))
    variance = declared**2 if np.isfinite(declared) else rss.sum() / windows.dof
    variance = max(variance, LEAST_SD**2)
    return windows.dof * np.log(variance) + logdet + rss.sum() / variance, float(np.sqrt(variance))


def minimise_deviance(deviance: Callable[[float], float]) -> float:
    """Minimise −2 log L over logit ρ."""
    return float(
        minimize_scalar(deviance, bounds=(-7.0, 7.6), method="bounded", options={"xatol": 1e-3}).x
    )
