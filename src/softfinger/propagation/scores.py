"""How well predicted distributions agree with recordings.

The scores of a new trial are coverage and CRPS.

References
----------
Gneiting, Raftery (2007), J. Am. Stat. Assoc. 102, 359, doi:10.1198/016214506000001437.
"""

from collections.abc import Iterable

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike, NDArray

CI_PROBS = (0.5, 0.9)
WINDOWS = {"whole": np.inf, "first_second": 1.0}  # up to this time [s]
_LEVELS = (np.arange(64) + 0.5) / 64  # equally probable values that represent a prediction
_EDGES = np.array([[(1 - p) / 2, (1 + p) / 2] for p in CI_PROBS])
PROBABILITIES = np.unique(np.concatenate([_LEVELS, _EDGES.ravel()]))
_LEVEL_PLACES = np.searchsorted(PROBABILITIES, _LEVELS)
_EDGE_PLACES = np.searchsorted(PROBABILITIES, _EDGES)


def compute_coverage_array(
    observed: NDArray[np.float64], lower: NDArray[np.float64], upper: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Compute the share of observations inside bounds.

    Observations are (…, n); NaN observations do not count.

    >>> compute_coverage_array(np.array([0.0, 2.0, np.nan]), np.full(3, -1.0), np.full(3, 1.0))
    array(0.5)
    """
    seen = np.isfinite(observed)
    inside = seen & (observed >= lower) & (observed <= upper)
    count = seen.sum(axis=-1)
    return np.where(count > 0, inside.sum(axis=-1) / np.maximum(count, 1), np.nan)


def compute_crps_array(observed: ArrayLike, predicted: NDArray[np.float64]) -> NDArray[np.float64]:
    """Compute the continuous ranked probability score.

    It is that of observations (…) [rad].

    Parameters
    ----------
    observed
        (…) [rad]; NaN gives NaN.
    predicted
        (m, …) [rad]: m equally probable values in rising order, best quantiles at (i + ½)/m.

    Returns
    -------
    (…) [rad]: (2/m) Σ (1{y < x_i} − (i + ½)/m) (x_i − y), which for one value is |y − x|.

    Examples
    --------
    >>> compute_crps_array(1.0, np.array([0.0, 2.0]))
    np.float64(0.5)
    """
    observed = np.asarray(observed, float)
    m = len(predicted)
    level = ((np.arange(m) + 0.5) / m).reshape(-1, *[1] * observed.ndim)
    loss = ((observed < predicted) - level) * (predicted - observed)
    return 2 * loss.mean(axis=0)


def bootstrap_mean_array(
    values: NDArray[np.float64], probability: float, rng: np.random.Generator, n: int = 2000
) -> NDArray[np.float64]:
    """Bootstrap the mean over trials.

    The result is equal-tailed bounds (2, …) of values (trial, …).

    A NaN value leaves its trial out of that mean. With fewer than two trials the bounds are NaN.

    >>> bootstrap_mean_array(np.ones((4, 1)), 0.9, np.random.default_rng(1))
    array([[1.],
           [1.]])
    """
    if len(values) < 2:
        return np.full((2, *values.shape[1:]), np.nan)
    weight = rng.multinomial(len(values), np.full(len(values), 1 / len(values)), size=n)
    seen = np.isfinite(values)
    total = np.tensordot(weight, np.where(seen, values, 0.0), axes=1)
    count = np.tensordot(weight, seen, axes=1)
    mean = np.where(count > 0, total / np.maximum(count, 1), np.nan)
    tail = (1 - probability) / 2
    unknown = ~seen.any(axis=0)
    mean[:, unknown] = 0.0
    bounds = np.nanquantile(mean, [tail, 1 - tail], axis=0)
    bounds[:, unknown] = np.nan
    return bounds


def score_recordings(
    time: NDArray[np.float64],
    angle: NDArray[np.float64],
    grid: NDArray[np.float64],
    predicted: Iterable[NDArray[np.float64]],
    rng: np.random.Generator,
) -> xr.Dataset:
    """Score predictions of a protocol.

    Parameters
    ----------
    time, angle
        (trial, frame) [s], (trial, joint, frame) [rad], NaN = missing.
    grid
        (time,) [s] of the predictions, which are interpolated to the frames.
    predicted
        For each trial (joint, time, p) [rad]: quantiles of its recording at `PROBABILITIES`.

    Returns
    -------
    Dataset
        coverage (window, joint, ci_prob), means over trials, coverage_bound (…, bound) of 90 % by
        bootstrap over trials, crps (window, joint) [rad]. NaN where nothing was recorded, or
        nothing predicted.
    """
    per_trial = [
        _score_trial(t, a, _interpolate(bands, grid, t))
        for t, a, bands in zip(time, angle, predicted, strict=True)
    ]
    coverage, crps = (np.stack(values) for values in zip(*per_trial, strict=True))
    dims = ("window", "joint", "ci_prob")
    bound = np.moveaxis(bootstrap_mean_array(coverage, 0.9, rng), 0, -1)
    return xr.Dataset(
        {
            "coverage": (dims, mean_over_trials(coverage)),
            "coverage_bound": ((*dims, "bound"), bound),
            "crps": (dims[:2], mean_over_trials(crps)),
        },
        coords={"window": list(WINDOWS), "ci_prob": list(CI_PROBS), "bound": ["lower", "upper"]},
    )


def mean_over_trials(values: NDArray[np.float64]) -> NDArray[np.float64]:
    """Mean over trials of known values.

    The trials are the first axis. It is NaN where nothing is known.

    >>> mean_over_trials(np.array([[1.0, np.nan], [np.nan, np.nan]]))
    array([ 1., nan])
    """
    seen = np.isfinite(values)
    count = seen.sum(axis=0)
    total = np.where(seen, values, 0.0).sum(axis=0)
    return np.where(count > 0, total / np.maximum(count, 1), np.nan)


def _score_trial(time: NDArray, angle: NDArray, predicted: NDArray) -> tuple[NDArray, NDArray]:
    """Trial's coverage (window, joint, ci_prob), CRPS (window, joint)."""
    known = np.where(np.isfinite(predicted).all(axis=-1), angle, np.nan)
    crps = compute_crps_array(known, np.moveaxis(predicted[..., _LEVEL_PLACES], -1, 0))
    coverage = np.empty((len(WINDOWS), len(angle), len(CI_PROBS)))
    score = np.empty(coverage.shape[:2])
    for w, end in enumerate(WINDOWS.values()):
        within = np.where(time <= end, known, np.nan)
        for p, (lower, upper) in enumerate(_EDGE_PLACES):
            coverage[w, :, p] = compute_coverage_array(
                within, predicted[..., lower], predicted[..., upper]
            )
        score[w] = mean_over_trials(np.where(np.isfinite(within), crps, np.nan).T)
    return coverage, score


def _interpolate(values: NDArray, grid: NDArray, time: NDArray) -> NDArray:
    """Values at frames, interpolated.

    Values (joint, time, m) become (joint, frame, m), NaN outside the grid.
    """
    known = np.where(np.isfinite(time), time, 0.0)
    after = np.clip(np.searchsorted(grid, known, side="left"), 1, grid.size - 1)
    share = (known - grid[after - 1]) / (grid[after] - grid[after - 1])
    share = np.where((share < 0) | (share > 1 + 1e-9) | np.isnan(time), np.nan, share)[:, None]
    return values[:, after - 1] * (1 - share) + values[:, after] * share
