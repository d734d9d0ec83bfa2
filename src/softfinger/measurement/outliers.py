"""Outliers among frames, found in what a model leaves.

Let r be what the model leaves, less its running median; the median keeps steps, so a slip is no
outlier. Let Λ be the precision of the noise. Then frame i adds to all the others
t_i² = (Λr)_iᵀ (Λ_ii)⁻¹ (Λr)_i, χ² with one degree of freedom a joint if the model is right.

Where the model is wrong, t_i² is large in many trials at the same time after a change of load. So
t_i² counts relative to its median among the frames that are alike (`alike.py`). A model's misfit is
then not cleaned away. Where too few are alike, none is judged. No frame is compared with one before
the last change.
An outlier raises its neighbours' t² as well, so only the peaks are taken, round after round.

A frame's time may be wrong by up to an interval: what the model moves by in the usual error of the
frames' times is no gross error.
Before a model is fitted, trials are not alike after a change of load: one may be many times faster
than the others. Then an angle on its way from what was before to what comes after is no outlier.

ASSUME: outliers are rare. A trial that would lose more than `most_outliers` keeps all its frames.
"""

import numpy as np
import xarray as xr
from numpy.typing import NDArray
from scipy.ndimage import median_filter
from scipy.stats import chi2

from softfinger.compiled import compiled
from softfinger.measurement.alike import find_usual_excess_array
from softfinger.measurement.budget import BUDGET
from softfinger.measurement.covariance import compute_innovation_covariance_array
from softfinger.measurement.decisions import DECISIONS
from softfinger.measurement.quiet import compute_time_since_array

Array = NDArray[np.float64]


def find_outliers(
    residual: Array,
    angles: xr.Dataset,
    frames: xr.Dataset,
    noise: xr.Dataset | None,
    passed: Array | None = None,
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
    passed
        As from `list_passed_array`, over the factor too; None where no model is fitted.
    """
    used, present = frames["used"].values, frames["present"].values
    time = angles["time"].transpose("trial", "frame").values
    interval = float(frames["frame_interval"])
    shortest = min(np.diff(t[u]).min(initial=interval) for t, u in zip(time, used, strict=True))
    found = np.zeros(used.shape)
    passed = np.zeros((2, *residual.shape)) if passed is None else np.nan_to_num(passed)
    freedom = np.maximum(present.sum(axis=1), 1)[:, None]
    distance, judged, since = (np.full(used.shape, np.nan) for _ in range(3))
    changed = used.any(axis=1)
    for _ in range(BUDGET.rounds):
        for trial in np.flatnonzero(changed):
            here, some = np.flatnonzero(present[trial]), used[trial] & (found[trial] == 0)
            load = (angles[name].values[trial] for name in ("load_time", "load_torque"))
            moment = time[trial, some]
            distance[trial], judged[trial], since[trial] = np.nan, np.nan, np.nan
            since[trial, some] = compute_time_since_array(moment, *load)
            gap = np.diff(moment) / interval
            gap[np.diff(since[trial, some]) < 0] = np.inf
            whole = residual[trial, here][:, some].T
            rows = subtract_median_array(whole, gap)
            low, high = passed[:, trial, here][:, :, some].transpose(0, 2, 1)
            if noise is None:
                usual = measure_usual_array(rows)
                passing = mark_passing_array(whole / usual)
                left = np.where(passing, 0.0, rows - rows.clip(low, high))
                sizes = [((part / usual) ** 2).sum(axis=1) for part in (rows, left)]
            else:
                sizes = measure_distance_array(rows, gap, *_read(noise, here), low, high)
            distance[trial, some], judged[trial, some] = sizes
        usual = find_usual_excess_array(distance / chi2.median(freedom), since, shortest)
        far = usual * chi2.isf(DECISIONS.good_lost, freedom)
        standing = (judged > far) & _find_peaks(judged)
        found = np.where(standing, judged, found)
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


def list_passed_array(motion: Array) -> Array:
    """List what a frame's wrong time may move it by.

    Least and largest (2, trial, joint, frame) [rad], for a motion (trial, joint, frame): it may
    show any angle that is passed between the frames beside it. Outside the recording it goes on.

    >>> list_passed_array(np.array([1.0, 3.0, 4.0, 4.0])).tolist()
    [[-2.0, -2.0, -1.0, 0.0], [2.0, 1.0, 0.0, 0.0]]
    """
    step = np.diff(motion)
    back = -np.concatenate([step[..., :1], step], axis=-1)
    on = np.concatenate([step, step[..., -1:]], axis=-1)
    beside = np.stack([back, 0.0 * motion, on])
    return np.stack([np.fmin.reduce(beside), np.fmax.reduce(beside)])


def find_time_error(residual: Array, passed: Array, used: NDArray[np.bool_]) -> float:
    """Find how far times are wrong, as a share of an interval.

    Frames are off by what the motion passes in the usual error of their times: of most, not of a
    few. Noise that lasts hides them, so a frame's deviation d is from the mean of those beside it;
    p² is the square of half of what the motion passes, in the frame and by halves beside it. From
    frames in which p is much more than their noise, s² = median(d²/p²)/0.455 − median(noise²/p²);
    excused is what a normal error of that sd has once in `good_lost`.

    Parameters
    ----------
    residual, passed
        (trial, joint, frame) and (2, trial, joint, frame) [rad].
    used
        (trial, frame).
    """
    seen = np.where(used[:, None], residual, np.nan)
    left = seen[..., 1:-1] - (seen[..., :-2] + seen[..., 2:]) / 2.0
    if not np.isfinite(left).any():
        return 1.0
    noise = np.nanmedian(np.abs(left), axis=(0, 2), keepdims=True) / 0.6745
    square = (passed[1] - passed[0]) ** 2 / 4.0
    half = np.sqrt(square[..., 1:-1] + (square[..., :-2] + square[..., 2:]) / 4.0)
    fast = np.isfinite(left) & (half > DECISIONS.gross_sd * noise)
    if not fast.any():
        return 1.0
    square = np.median((left[fast] / half[fast]) ** 2) / chi2.median(1)
    square -= np.median((np.broadcast_to(noise, half.shape)[fast] / half[fast]) ** 2)
    return float(min(np.sqrt(max(square, 0.0) * chi2.isf(DECISIONS.good_lost, 1)), 1.0))


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


def measure_usual_array(rows: Array) -> Array:
    """Usual size (joint,) of series (n, joint); infinite if none."""
    usual = np.median(np.abs(rows), axis=0) / 0.6745
    return np.where(usual > 0, usual, np.inf)


def mark_passing_array(angle: Array) -> NDArray[np.bool_]:
    """Mark angles (n, joint), in units of the noise, on their way.

    But for the noise, they lie between the frames beside them, and between the medians of as many
    frames before and after as the running median takes: a burst returns to where it came from.

    >>> rise = np.concatenate([np.zeros(20), [50.0, 80.0], 90.0 + np.zeros(20)])
    >>> rise[[30, 31, 36]] = 40.0, 40.0, 100.0
    >>> np.flatnonzero(~mark_passing_array(rise[:, None]))
    array([30, 31, 36])
    """
    passing, slack = np.ones(angle.shape, bool), np.sqrt(chi2.isf(DECISIONS.good_lost, 1))
    for width in (1, DECISIONS.median_frames):
        padded, half = np.pad(angle, ((width, width), (0, 0)), mode="edge"), width // 2
        median = median_filter(padded, (width, 1), mode="nearest")
        before, after = (median[width + away :][: len(angle)] for away in (-half - 1, half + 1))
        passing &= angle >= np.minimum(before, after) - slack
        passing &= angle <= np.maximum(before, after) + slack
    return passing


def measure_distance_array(
    residual: Array,
    gap: Array,
    sd: Array,
    autocorrelation: Array,
    white: Array,
    correlation: Array,
    low: Array,
    high: Array,
) -> tuple[Array, Array]:
    """Measure t² (n,) of each frame against its neighbours.

    Also what is left of it if its time is wrong.

    Parameters
    ----------
    residual
        (n, joint) [rad], of the joints that are present.
    gap
        (n − 1,) between frames, in median intervals; infinite between those to be kept apart.
    sd, autocorrelation, white, correlation
        (joint,), (joint,), (joint,), (joint, joint) of their noise.
    low, high
        (n, joint) [rad] that a wrong time may move a frame by.
    """
    kinds, index = np.unique(np.round(gap, 3), return_inverse=True)
    kept = (1.0 - white) * autocorrelation ** kinds[:, None]
    covariance = [compute_innovation_covariance_array(1.0, sd, k, correlation) for k in kept]
    first = compute_innovation_covariance_array(np.inf, sd, autocorrelation, correlation)
    precision = np.linalg.inv(np.stack([*covariance, first]))
    return _sum_distance(residual, kept, precision, index, low, high)


@compiled(error_model="numpy")
def _sum_distance(
    residual: NDArray,
    kept: NDArray,
    precision: NDArray,
    index: NDArray,
    low: NDArray,
    high: NDArray,
) -> tuple[NDArray, NDArray]:
    """Λ of frame i.

    P of its own gain, plus what its share in the next frame's adds. Λ_ii⁻¹ (Λr)_i is how far the
    frame is from what all others predict. Of the two beside it, the times may be wrong too.
    """
    count, joints = residual.shape
    distance, judged = np.empty(count), np.empty(count)
    for i in range(count):
        own = precision[-1] if i == 0 else precision[index[i - 1]]
        gain, beside = residual[i].copy(), np.zeros((2, joints))
        if i > 0:
            gain -= kept[index[i - 1]] * residual[i - 1]
            beside[0] = np.diag(own) * kept[index[i - 1]]
        pull, diagonal = own @ gain, own.copy()
        if i < count - 1:
            share = kept[index[i]]
            after = precision[index[i]]
            beside[1] = np.diag(after) * share
            lost = after @ (residual[i + 1] - share * residual[i])
            for j in range(joints):
                pull[j] -= share[j] * lost[j]
                for k in range(joints):
                    diagonal[j, k] += share[j] * share[k] * after[j, k]
        away = np.linalg.solve(diagonal, pull)
        distance[i] = pull @ away
        least, most = low[i] ** 2, high[i] ** 2
        for side, other in enumerate((i - 1, i + 1)):
            if 0 <= other < count:
                weight = beside[side] / np.diag(diagonal)
                least += (weight * high[other]) ** 2
                most += (weight * low[other]) ** 2
        left = away - np.minimum(np.maximum(away, -np.sqrt(least)), np.sqrt(most))
        judged[i] = min(left @ (diagonal @ left), distance[i])
    return distance, judged


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
