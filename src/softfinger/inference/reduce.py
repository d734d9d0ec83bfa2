"""Whitened Gram matrix of each trial."""

import numpy as np
from numpy.typing import NDArray

from softfinger.compiled import compiled
from softfinger.compiled.threads import run_side_by_side
from softfinger.measurement.trials import Trials


def reduce_trials(
    trials: Trials, angle: NDArray[np.float64], slope: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Reduce a model to Gram matrices of its trials.

    Of [slope | residual]: (trial, column + 1, column + 1).

    Parameters
    ----------
    angle, slope
        (trial, joint, bin · 2) [rad] at the nodes, and (trial, joint, bin · 2, column).
    """
    t = trials
    by_trial = angle, slope, t.angle, t.bins, t.present, t.scale, t.protocol, t.trust, t.soft

    def run(some: slice) -> tuple[NDArray]:
        return (_reduce(t.band, t.first, *(array[some] for array in by_trial)),)

    return run_side_by_side(run, len(angle))[0]


@compiled
def _reduce(
    band: NDArray,
    first: NDArray,
    angle: NDArray,
    slope: NDArray,
    seen: NDArray,
    bins: NDArray,
    present: NDArray,
    scale: NDArray,
    protocol: NDArray,
    trust: NDArray,
    soft: NDArray,
) -> NDArray:
    trials, columns = angle.shape[0], slope.shape[3]
    gram = np.empty((trials, columns + 1, columns + 1))
    for i in range(trials):
        kind = protocol[i]
        rows = _collect_rows(angle[i], slope[i], seen[i], bins[i], present[i], scale[i])
        white = _soften(_whiten_band(band[kind], first[kind], rows, trust[i]), soft[i])
        gram[i] = white.T @ white
    return gram


@compiled
def _collect_rows(
    angle: NDArray, slope: NDArray, seen: NDArray, bins: int, present: NDArray, scale: NDArray
) -> NDArray:
    """Rows (row, column + 1) of one trial.

    A row is a bin and a present joint, joints fastest: the mean of the bin's two nodes,
    over the scale of its noise.
    """
    columns = slope.shape[2]
    rows = np.empty((bins * present.sum(), columns + 1))
    row = 0
    for b in range(bins):
        for j in range(present.size):
            if present[j]:
                half = 0.5 / scale[b, j]
                for c in range(columns):
                    rows[row, c] = half * (slope[j, 2 * b, c] + slope[j, 2 * b + 1, c])
                mean = 0.5 * (angle[j, 2 * b] + angle[j, 2 * b + 1])
                rows[row, columns] = (seen[b, j] - mean) / scale[b, j]
                row += 1
    return rows


@compiled
def _whiten_band(band: NDArray, first: NDArray, rows: NDArray, trust: NDArray) -> NDArray:
    white = np.zeros_like(rows)
    for i in range(rows.shape[0]):
        for a in range(first[i], i + 1):
            weight = trust[i] * band[i, a - first[i]]
            for c in range(rows.shape[1]):
                white[i, c] += weight * rows[a, c]
    return white


@compiled
def _soften(white: NDArray, soft: NDArray) -> NDArray:
    """Rows x − D Dᵀ x."""
    if soft.shape[1] == 0:
        return white
    direction = np.ascontiguousarray(soft[: white.shape[0]])
    return white - direction @ (direction.T @ white)


def whiten_slope(trials: Trials, slope: NDArray[np.float64], trial: int) -> NDArray[np.float64]:
    """Whitened rows (row, column) of one trial's slopes.

    Slopes are (trial, joint, bin · 2, column).
    """
    present, kind = trials.present[trial], trials.protocol[trial]
    nothing = np.zeros(slope.shape[1:3])
    slope, seen = np.ascontiguousarray(slope[trial]), np.zeros_like(trials.angle[trial])
    rows = _collect_rows(nothing, slope, seen, trials.bins[trial], present, trials.scale[trial])
    band, first = trials.band[kind], trials.first[kind]
    return _whiten_band(band, first, rows, trials.trust[trial])[:, :-1]


def whiten_residual(trials: Trials, angle: NDArray[np.float64], trial: int) -> NDArray[np.float64]:
    """Whitened residual (bin, joint), NaN where unseen."""
    empty = np.zeros((*angle.shape[1:], 0))
    present, kind = trials.present[trial], trials.protocol[trial]
    seen, scale = trials.angle[trial], trials.scale[trial]
    rows = _collect_rows(angle[trial], empty, seen, trials.bins[trial], present, scale)
    white = np.full((trials.bins[trial], trials.joints), np.nan)
    rows = _whiten_band(trials.band[kind], trials.first[kind], rows, trials.trust[trial])
    white[:, present] = _soften(rows, trials.soft[trial]).reshape(-1, present.sum())
    return white
