"""Outliers among frames, found in what a model leaves.

Let r be what the model leaves, less its running median; the median keeps steps, so a slip is no
outlier. Let Λ be the precision of the noise. Then frame i adds to all the others
t_i² = (Λr)_iᵀ (Λ_ii)⁻¹ (Λr)_i, χ² with one degree of freedom a joint if the model is right.

Where the model is wrong, t_i² is large in many trials at the same time after a change of load. So
t_i² counts relative to its median among the frames that have as long a time since the last change
of load, of all trials and changes. A model's misfit is then not cleaned away. Where fewer than
`least_alike` frames compare, those a little sooner and later do too; where these are too few, none
is judged. No frame is compared with one before the last change.
An outlier raises its neighbours' t² as well, so only the peaks are taken, round after round.

ASSUME: outliers are rare. A trial that would lose more than `most_outliers` keeps all its frames.
"""

import numpy as np
import xarray as xr
from numpy.typing import NDArray
from scipy.ndimage import median_filter
from scipy.stats import chi2

from softfinger.compiled import compiled
from softfinger.measurement.budget import BUDGET
from softfinger.measurement.covariance import compute_innovation_covariance_array
from softfinger.measurement.decisions import DECISIONS
from softfinger.measurement.quiet import compute_time_since_array

Array = NDArray[np.float64]


def find_outliers(
    residual: Array, angles: xr.Dataset, frames: xr.Dataset, noise: xr.Dataset | None
) -> Array:
    """Find the outliers among the used frames.

    Their t² (trial, frame), 0 for all others.

    Parameters
    ----------
    residual
        (trial, joint, frame) [rad] that a model leaves, over the factor of each frame's noise.
    angles, frames
        The `angles` artifact, and its frames as `select_frames` describes them.
    noise
        As from `fit_noise`; None where it is not known yet: then frames count by their size
        over the trial's usual one.
    """
    used, present = frames["used"].values, frames["present"].values
    time = angles["time"].transpose("trial", "frame").values
    interval = float(frames["frame_interval"])
    found = np.zeros(used.shape)
    freedom = np.maximum(present.sum(axis=1), 1)[:, None]
    distance, since = (np.full(used.shape, np.nan) for _ in range(2))
    changed = used.any(axis=1)
    for _ in range(BUDGET.rounds):
        for trial in np.flatnonzero(changed):
            here, some = np.flatnonzero(present[trial]), used[trial] & (found[trial] == 0)
            load = (angles[name].values[trial] for name in ("load_time", "load_torque"))
            moment = time[trial, some]
            distance[trial], since[trial] = np.nan, np.nan
            since[trial, some] = compute_time_since_array(moment, *load)
            gap = np.diff(moment) / interval
            gap[np.diff(since[trial, some]) < 0] = np.inf
            rows = subtract_median_array(residual[trial, here][:, some].T, gap)
            if noise is None:
                distance[trial, some] = compare_usual_array(rows)
            else:
                distance[trial, some] = measure_distance_array(rows, gap, *_read(noise, here))
        usual = _find_usual(distance / chi2.median(freedom), since)
        far = usual * chi2.isf(DECISIONS.good_lost, freedom)
        standing = (distance > far) & _find_peaks(distance)
        found = np.where(standing, distance, found)
        changed = standing.any(axis=1)
        if not changed.any():
            break
    too_many = (found > 0).sum(axis=1) > DECISIONS.most_outliers * used.sum(axis=1)
    return np.where(too_many[:, None], 0.0, found)


def _read(noise: xr.Dataset, here: NDArray) -> tuple[Array, Array, Array, Array]:
    """Sd, memory and correlation of the present joints' noise."""
    names = ("noise_sd", "noise_autocorrelation", "noise_white")
    sd, rho, white = (noise[name].values[here] for name in names)
    return sd, rho, white, noise["noise_correlation"].values[np.ix_(here, here)]


def subtract_median_array(rows: Array, gap: Array) -> Array:
    """Subtract from series (n, joint) their running median.

    The median runs between infinite gaps (n − 1,).

    >>> step = np.repeat([[0.0], [1.0]], 20, axis=0)
    >>> step[7] = 5.0
    >>> np.flatnonzero(subtract_median_array(step, np.ones(39)))
    array([7])
    """
    parts = np.split(rows, np.flatnonzero(~np.isfinite(gap)) + 1)
    return np.concatenate(
        [part - median_filter(part, (DECISIONS.median_frames, 1), mode="mirror") for part in parts]
    )


def compare_usual_array(rows: Array) -> Array:
    """Squared size (n,) of frames (n, joint).

    It is in units of each joint's usual size, summed over joints.
    """
    usual = np.median(np.abs(rows), axis=0) / 0.6745
    return ((rows / np.where(usual > 0, usual, np.inf)) ** 2).sum(axis=1)


def measure_distance_array(
    residual: Array, gap: Array, sd: Array, autocorrelation: Array, white: Array, correlation: Array
) -> Array:
    """Measure t² (n,) of each frame against its neighbours.

    Parameters
    ----------
    residual
        (n, joint) [rad], of the joints that are present.
    gap
        (n − 1,) between frames, in median intervals; infinite between those to be kept apart.
    sd, autocorrelation, white, correlation
        (joint,), (joint,), (joint,), (joint, joint) of their noise.
    """
    kinds, index = np.unique(np.round(gap, 3), return_inverse=True)
    kept = (1.0 - white) * autocorrelation ** kinds[:, None]
    covariance = [compute_innovation_covariance_array(1.0, sd, k, correlation) for k in kept]
    first = compute_innovation_covariance_array(np.inf, sd, autocorrelation, correlation)
    precision = np.linalg.inv(np.stack([*covariance, first]))
    return _sum_distance(residual, kept, precision, index)


@compiled(error_model="numpy")
def _sum_distance(residual: NDArray, kept: NDArray, precision: NDArray, index: NDArray) -> NDArray:
    """Λ of frame i.

    P of its own gain, plus what its share in the next frame's adds.
    """
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


def _find_peaks(distance: Array) -> NDArray[np.bool_]:
    """Mark the frames with the largest t² around.

    A frame counts if the used ones beside it have no more.
    """
    peaks = np.zeros(distance.shape, bool)
    for row, mark in zip(distance, peaks, strict=True):
        some = np.flatnonzero(np.isfinite(row))
        padded = np.pad(row[some], 1, constant_values=-np.inf)
        mark[some] = (padded[1:-1] >= padded[:-2]) & (padded[1:-1] >= padded[2:])
    return peaks


def _find_usual(excess: Array, since: Array) -> Array:
    """How far a usual frame exceeds its due.

    As a multiple, at each time since a change.

    At least 1; infinite where too few frames compare.
    """
    finite = np.isfinite(excess)
    floor = np.median(since[finite]) * 1e-3
    place = np.floor(DECISIONS.alike_per_decade * np.log10(np.maximum(since, floor) / floor))
    usual = np.full(excess.shape, np.inf)
    for value in np.unique(place[finite]):
        some = finite & (place == value)
        alike = some if some.sum() >= DECISIONS.least_alike else finite & (abs(place - value) <= 1)
        if alike.sum() >= DECISIONS.least_alike:
            usual[some] = max(float(np.median(excess[alike])), 1.0)
    return usual
