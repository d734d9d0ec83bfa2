"""Frames that stand out from their neighbours, found against the pilot fit and then left out.

With r the residuals at the trials' modes and Λ the precision of the noise, what frame i adds to all
the others is t_i² = (Λr)_iᵀ (Λ_ii)⁻¹ (Λr)_i, which is χ² with one degree of freedom a joint if the
model is right. Where it is wrong, many trials stand out at the same time after a change of load;
so t_i² counts relative to its median among the frames, of all trials, that have as long a time
since the last change of load, and a model's misfit is not cleaned away. An outlier makes its
neighbours stand out as well, so only the peaks are taken, round after round.

ASSUME: outliers are rare. A trial that would lose more than 5 % of its frames keeps them all.
"""

import numpy as np
import xarray as xr
from numba import njit
from numpy.typing import NDArray
from scipy.stats import chi2

from softfinger.mechanics.three_element import compute_joint_angle_array
from softfinger.population.covariance import compute_innovation_covariance_array
from softfinger.population.pilot import Noise, Pilot
from softfinger.population.quiet import find_load_changes_array

TAIL = 1e-5  # chance of a good frame to be left out
MOST_SHARE = 0.05
ROUNDS = 10
BINS_PER_DECADE = 8
LEAST_IN_BIN = 12


def find_outliers(angles: xr.Dataset, frames: xr.Dataset, pilot: Pilot) -> xr.DataArray:
    """Find the used frames (trial, frame) that stand out from their neighbours.

    Parameters
    ----------
    angles, frames
        The `angles` artifact and what `select_frames` says of it.
    pilot
        What `fit_pilot` makes of them.
    """
    used = frames["used"].values.copy()
    found = np.zeros_like(used)
    freedom = np.maximum(frames["present"].values.sum(axis=1), 1)[:, None]
    distance, since = (np.full(used.shape, np.nan) for _ in range(2))
    changed = used.any(axis=1)
    for _ in range(ROUNDS):
        _measure_trials(angles, frames, pilot, used & ~found, changed, distance, since)
        usual = _find_usual(distance / chi2.median(freedom), since)
        standing = (distance > usual * chi2.isf(TAIL, freedom)) & _find_peaks(distance)
        found |= standing
        changed = standing.any(axis=1)
        if not standing.any():
            break
    too_many = found.sum(axis=1) > MOST_SHARE * used.sum(axis=1)
    return xr.DataArray(found & ~too_many[:, None], dims=("trial", "frame"))


def _measure_trials(
    angles: xr.Dataset,
    frames: xr.Dataset,
    pilot: Pilot,
    used: NDArray,
    which: NDArray,
    distance: NDArray,
    since: NDArray,
) -> None:
    """Write t² and the time since the last change of load of some trials; NaN where not used."""
    distance[which], since[which] = np.nan, np.nan
    time = angles["time"].transpose("trial", "frame").values
    for trial in np.flatnonzero(which):
        here, some = np.flatnonzero(frames["present"].values[trial]), used[trial]
        residual = _compute_residual(angles, frames, pilot, trial, here)[some]
        gap = np.diff(time[trial, some]) / float(frames["frame_interval"])
        distance[trial, some] = measure_distance_array(residual, gap, pilot.noise, here)
        since[trial, some] = _measure_since(angles, trial, time[trial, some])


def _find_peaks(distance: NDArray) -> NDArray[np.bool_]:
    """Mark the frames that stand out at least as much as the used ones beside them."""
    peaks = np.zeros(distance.shape, bool)
    for row, mark in zip(distance, peaks, strict=True):
        some = np.flatnonzero(np.isfinite(row))
        padded = np.pad(row[some], 1, constant_values=-np.inf)
        mark[some] = (padded[1:-1] >= padded[:-2]) & (padded[1:-1] >= padded[2:])
    return peaks


def measure_distance_array(
    residual: NDArray[np.float64],
    gap: NDArray[np.float64],
    noise: Noise,
    here: NDArray[np.int64],
) -> NDArray[np.float64]:
    """Measure t² (n,) of each frame against its neighbours.

    Parameters
    ----------
    residual
        (n, joints present) [rad].
    gap
        (n − 1,) between frames, in median intervals.
    noise
        Of all joints.
    here
        Which joints are present.
    """
    sd, rho = noise.sd[here], noise.autocorrelation[here]
    correlation = noise.correlation[np.ix_(here, here)]
    kinds, index = np.unique(np.round(gap, 3), return_inverse=True)
    covariance = [compute_innovation_covariance_array(g, sd, rho, correlation) for g in kinds]
    first = compute_innovation_covariance_array(np.inf, sd, rho, correlation)
    precision = np.linalg.inv(np.stack([*covariance, first]))
    return _sum_distance(residual, rho ** kinds[:, None], precision, index)


@njit(cache=True, error_model="numpy")
def _sum_distance(residual: NDArray, kept: NDArray, precision: NDArray, index: NDArray) -> NDArray:
    """Λ of frame i: P of its own gain plus what its share in the next frame's adds."""
    count, joints = residual.shape
    distance = np.empty(count)
    for i in range(count):
        own = precision[-1] if i == 0 else precision[index[i - 1]]
        gain = residual[i].copy()
        if i > 0:
            gain -= kept[index[i - 1]] * residual[i - 1]
        pull, diagonal = own @ gain, own.copy()
        if i < count - 1:
            share = kept[index[i]]
            after = precision[index[i]]
            lost = after @ (residual[i + 1] - share * residual[i])
            for j in range(joints):
                pull[j] -= share[j] * lost[j]
                for k in range(joints):
                    diagonal[j, k] += share[j] * share[k] * after[j, k]
        distance[i] = pull @ np.linalg.solve(diagonal, pull)
    return distance


def _compute_residual(
    angles: xr.Dataset, frames: xr.Dataset, pilot: Pilot, trial: int, here: NDArray
) -> NDArray:
    """Recording minus motion at the mode (frame, joints present) [rad], over the frame's scale."""
    eta = pilot.modes.eta[trial].reshape(-1, 4)[here]
    motion = compute_joint_angle_array(
        *np.exp(eta[:, :3].T),
        eta[:, 3],
        angles["time"].transpose("trial", "frame").values[trial],
        *(angles[name].values[trial] for name in ("load_time", "load_torque")),
    )
    recorded = angles["joint_angle"].transpose("trial", "joint", "frame").values[trial, here]
    return ((recorded - motion) / frames["frame_scale"].values[trial]).T


def _measure_since(angles: xr.Dataset, trial: int, time: NDArray) -> NDArray:
    """Time [s] since the last change of load, or since the recording began."""
    load = (angles[name].values[trial] for name in ("load_time", "load_torque"))
    changes = np.concatenate([[time[0]], find_load_changes_array(*load)])
    last = np.searchsorted(np.sort(changes), time, side="right") - 1
    return time - np.sort(changes)[np.maximum(last, 0)]


def _find_usual(excess: NDArray, since: NDArray) -> NDArray:
    """Find how many times its due a usual frame has, at each time since a change; at least 1."""
    finite = np.isfinite(excess)
    floor = np.median(since[finite]) * 1e-3
    place = np.floor(BINS_PER_DECADE * np.log10(np.maximum(since, floor) / floor))
    usual = np.ones(excess.shape)
    for value in np.unique(place[finite]):
        some = finite & (place == value)
        if some.sum() >= LEAST_IN_BIN:
            usual[some] = max(float(np.median(excess[some])), 1.0)
    return usual
