"""Restricted likelihood of the noise in quiet windows.

The windows may contain any smooth motion; how long the noise lasts is a `memory.Memory`.

In quiet zones, away from changes of load, every motion of the finger is smooth: a quartic in time
follows it over a window of at most 200 frames. What the quartic leaves is noise, and the restricted
likelihood (REML) of the window takes account of the noise that the quartic absorbed:

    −2 log L(σ, ρ, w) = (n − p) log σ² + log|R| + log|XᵀR⁻¹X| + yᵀ(R⁻¹ − R⁻¹X(XᵀR⁻¹X)⁻¹XᵀR⁻¹)y / σ²

Windows cannot separate noise that outlasts them from a drift without end. So how long it lasts,
τ = −1/log ρ frames, has an exponential prior with a mean of a quarter of a window.

References
----------
Patterson, Thompson (1971), Biometrika 58, 545, doi:10.1093/biomet/58.3.545.
"""

from collections.abc import Callable, Iterable
from typing import NamedTuple

import numpy as np
import xarray as xr
from numpy.typing import NDArray
from scipy.optimize import minimize, minimize_scalar
from scipy.special import expit, logit

from softfinger.compiled import compiled
from softfinger.measurement.budget import BUDGET
from softfinger.measurement.decisions import DECISIONS
from softfinger.measurement.memory import Memory, correlate_frames, fill_white
from softfinger.measurement.priors import PRIORS
from softfinger.measurement.quiet import split_smooth

DEGREE = PRIORS.degree  # of the polynomial that follows the motion of a window
LEAST_SD = 1e-9  # [rad] far below any camera's noise: a frozen recording has none


@compiled
def profile_windows(
    rho: float,
    share: float,
    position: NDArray,
    angle: NDArray,
    gap: NDArray,
    start: NDArray,
    residual: NDArray,
) -> tuple[NDArray, float]:
    """RSS of each window, and Σ (log|R| + log|XᵀR⁻¹X|).

    It fills `residual` (n,), whitened.
    """
    rss, logdet = np.zeros(start.size - 1), 0.0
    for window in range(start.size - 1):
        part = slice(start[window], start[window + 1])
        rows = np.empty((start[window + 1] - start[window], DEGREE + 2))
        rows[:, DEGREE], rows[:, DEGREE + 1] = 1.0, angle[part]
        for power in range(DEGREE - 1, -1, -1):
            rows[:, power] = rows[:, power + 1] * position[part]
        white = np.empty_like(rows)
        logdet += fill_white(rows, gap[part], rho, share, white)
        design, value = np.ascontiguousarray(white[:, :-1]), np.ascontiguousarray(white[:, -1])
        gram = design.T @ design
        left = value - design @ np.linalg.solve(gram, design.T @ value)
        logdet += np.log(np.linalg.det(gram))
        residual[part] = left
        rss[window] = left @ left
    return rss, logdet


class Windows(NamedTuple):
    """Quiet windows of a joint, end to end.

    Attributes
    ----------
    position
        (n,) of a frame in its window, from −1 to 1.
    angle
        (n,) [rad], over the factor of the frame's noise.
    gap
        (n,) time since the row before, in median frame intervals.
    start
        (window + 1,) first row of each window, and the end.
    place
        (n,) trial · frames + frame, to match joints with each other.
    at_rest
        (window,) whether the finger rests in it; if not, it shows how long noise lasts, and
        neither its size nor its tails.
    """

    position: NDArray
    angle: NDArray
    gap: NDArray
    start: NDArray
    place: NDArray
    at_rest: NDArray

    @property
    def rest(self) -> "Windows":
        """Those at rest; all where none is."""
        return self.keep(self.at_rest) if self.at_rest.any() else self

    @property
    def dof(self) -> int:
        """Rows that the quartics leave free."""
        return len(self.angle) - (DEGREE + 1) * (len(self.start) - 1)

    def keep(self, chosen: NDArray[np.bool_]) -> "Windows":
        """Keep the chosen windows (window,)."""
        sizes = np.diff(self.start)
        if chosen.all():
            return self
        row = np.repeat(chosen, sizes)
        start = np.concatenate([[0], np.cumsum(sizes[chosen])])
        return Windows(
            *(part[row] for part in self[:3]), start, self.place[row], self.at_rest[chosen]
        )

    def thin(self, rows: int) -> "Windows":
        """Keep about so many rows, in windows spread evenly."""
        number = len(self.start) - 1
        if len(self.angle) <= rows:
            return self
        chosen = np.zeros(number, bool)
        chosen[np.linspace(0, number - 1, -(-number * rows // len(self.angle))).astype(int)] = True
        return self.keep(chosen)


def cut_windows(angles: xr.Dataset, frames: xr.Dataset) -> list[Windows]:
    """Cut the quiet frames of every joint into windows.

    The frames are those of all trials.
    """
    every, trial = _find_quiet(angles, frames)
    angle = angles["joint_angle"].transpose("trial", "joint", "frame").values
    angle = angle / frames["frame_scale"].values[:, None]
    if "noise_factor" in frames:
        angle = angle / frames["noise_factor"].values
    present, found = frames["present"].values, []
    for joint in range(angle.shape[1]):
        here = every.keep(present[trial, joint])
        found.append(here._replace(angle=angle[:, joint].ravel()[here.place]))
    return found


def whiten_windows(windows: list[Windows], memories: Iterable[Memory]) -> list[NDArray]:
    """What each joint's windows leave (n,), whitened.

    It is not filled for a joint whose memory is unknown.
    """
    left = []
    for part, memory in zip(windows, memories, strict=True):
        residual = np.zeros(len(part.angle))
        if np.isfinite(memory.autocorrelation):
            profile_windows(*memory, *part[:4], residual)
        left.append(residual)
    return left


def _find_quiet(angles: xr.Dataset, frames: xr.Dataset) -> tuple[Windows, NDArray]:
    """Quiet windows of all trials, without angles, and their trials (window,)."""
    time = angles["time"].transpose("trial", "frame").values
    interval = float(frames["frame_interval"])
    names = ("load_time", "load_torque")
    loads = [angles[name].transpose("trial", "knot").values for name in names]
    positions, gaps, places = [np.empty(0)], [np.empty(0)], [np.empty(0, int)]
    sizes, trials, at_rest = [0], [], []
    for trial in np.flatnonzero(frames["present"].values.any(axis=1)):
        index = np.flatnonzero(frames["used"].values[trial])
        runs = split_smooth(time[trial, index], *(load[trial] for load in loads))
        for part, is_at_rest in _split_evenly([(index[run], rests) for run, rests in runs]):
            t = time[trial, part]
            positions.append(2 * (t - t[0]) / (t[-1] - t[0]) - 1)
            gaps.append(np.diff(t, prepend=-np.inf) / interval)
            places.append(trial * time.shape[1] + part)
            sizes.append(len(part))
            trials.append(trial)
            at_rest.append(is_at_rest)
    position, gap, place = (np.concatenate(parts) for parts in (positions, gaps, places))
    rest = np.array(at_rest, bool)
    found = Windows(position, np.zeros(len(place)), gap, np.cumsum(sizes), place, rest)
    return found, np.array(trials, int)


def _split_evenly(runs: list[tuple[NDArray, bool]]) -> list[tuple[NDArray, bool]]:
    """Split runs of quiet frames into even windows.

    Each has at most `window_frames`.
    """
    windows = []
    for run, rests in runs:
        number = -(-len(run) // DECISIONS.window_frames)
        windows += [(window, rests) for window in np.array_split(run, number)]
    return [part for part in windows if len(part[0]) >= DECISIONS.least_window_frames]


def fit_joint(windows: Windows, declared: float) -> tuple[float, Memory, Windows]:
    """Fit σ and the memory, then again in calm windows.

    Calm windows are not three times as lively as most.
    """
    if windows.dof <= 0:
        return declared, Memory(np.nan), windows
    if not windows.at_rest.all() and _remembers(windows.rest, declared):
        windows = windows.rest
    _, memory = _maximise_reml(windows, declared)
    rss, _ = profile_windows(*memory, *windows[:4], np.empty(len(windows.angle)))
    variance = rss / (np.diff(windows.start) - DEGREE - 1)
    usual = variance[windows.at_rest] if windows.at_rest.any() else variance
    calm = windows.keep(variance <= DECISIONS.lively * np.median(usual))
    return *_maximise_reml(calm, declared), calm


def _remembers(windows: Windows, declared: float) -> bool:
    """Whether neighbouring frames remember each other.

    Then these windows show by themselves how long noise lasts.
    """
    gap = np.median(windows.gap[np.isfinite(windows.gap)], keepdims=True)
    return bool(correlate_frames(find_memory([windows], declared), gap)[0] >= DECISIONS.remembers)


def _maximise_reml(windows: Windows, declared: float) -> tuple[float, Memory]:
    memory = find_memory([windows], declared)
    return evaluate_reml(windows.rest, memory, declared)[1], memory


def find_memory(windows: list[Windows], declared: float) -> Memory:
    """Find the most probable memory that all joints share.

    Each joint has its own best σ. A white share is there where it has evidence: first a few shares
    are tried, at the ρ that has the same correlation over a frame. Of long recordings some windows
    are enough.
    """
    frames = PRIORS.lasting_windows * DECISIONS.window_frames
    windows = [part.thin(BUDGET.memory_rows) for part in windows]

    def deviance(memory: Memory) -> float:
        lasting = -2.0 / np.log(memory.autocorrelation) / frames
        return lasting + sum(evaluate_reml(part, memory, declared)[0] for part in windows)

    alone = Memory(float(expit(minimise_deviance(lambda x: deviance(Memory(float(expit(x))))))))
    worth = deviance(alone) - 2.0 * DECISIONS.present_nats
    starts = [
        Memory(alone.autocorrelation / (1.0 - share), share)
        for share in PRIORS.white_shares
        if alone.autocorrelation < PRIORS.longest_memory * (1.0 - share)
    ]
    start = min(starts, key=deviance, default=alone)
    if deviance(start) > worth:
        return alone
    found = minimize(
        lambda x: deviance(Memory(*expit(x))),
        logit(start),
        method="Nelder-Mead",
        bounds=[(-7.0, 7.6), (-9.0, 5.0)],
        options={"xatol": 0.02, "fatol": 0.05, "maxfev": BUDGET.memory_evaluations},
    )
    return Memory(*map(float, expit(found.x)))


def evaluate_reml(windows: Windows, memory: Memory, declared: float) -> tuple[float, float]:
    """−2 log L at a memory, and its best σ."""
    rss, logdet = profile_windows(*memory, *windows[:4], np.empty(len(windows.angle)))
    variance = declared**2 if np.isfinite(declared) else rss.sum() / windows.dof
    variance = max(variance, LEAST_SD**2)
    return windows.dof * np.log(variance) + logdet + rss.sum() / variance, float(np.sqrt(variance))


def minimise_deviance(deviance: Callable[[float], float]) -> float:
    """Minimise −2 log L over logit ρ."""
    return float(
        minimize_scalar(deviance, bounds=(-7.0, 7.6), method="bounded", options={"xatol": 1e-3}).x
    )
