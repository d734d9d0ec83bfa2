"""Repeated frames, and angles rounded to a step.

A frame whose angles are all exactly those of the frame before gives no information: the camera or
its reader repeated it. Where angles are rounded so coarsely that equal neighbours come by chance,
none counts as repeated; but an angle rounded to a step errs by at least step/√12. A step may change
within a trial, where numbers have so many digits or an instrument its ranges; so it is sought in
blocks of frames.
"""

import numpy as np
import xarray as xr
from numpy.typing import NDArray
from scipy.ndimage import maximum_filter1d

from softfinger.compiled import compiled
from softfinger.measurement.budget import BUDGET
from softfinger.measurement.decisions import DECISIONS


def find_repeated_frames(angles: xr.Dataset, frames: xr.Dataset) -> NDArray[np.bool_]:
    """Find the used frames that repeat the one before.

    Both are used; the result is (trial, frame). What is repeated right after a gap may itself
    repeat a frame that was lost, so it is marked too.
    """
    angle = angles["joint_angle"].transpose("trial", "joint", "frame").values
    used, present = frames["used"].values, frames["present"].values
    found = np.zeros_like(used)
    for trial in np.flatnonzero(used.any(axis=1)):
        rows = angle[trial, present[trial]][:, used[trial]]
        same = (np.diff(rows, axis=1) == 0.0).all(axis=0)
        found[trial, np.flatnonzero(used[trial])[1:]] = same
    if found.any():
        chance = np.where(present[:, :, None], _expect_equals(angle, used), 1.0).prod(axis=1)
        held = weigh_held_array(chance[found], int(used.sum()))
        found[found] = held > DECISIONS.least_held
    time = angles["time"].transpose("trial", "frame").values
    for trial, seen in enumerate(used):
        place = np.flatnonzero(seen)
        since = np.diff(time[trial, place], prepend=np.nan)
        after_gap = since > 1.5 * float(frames["frame_interval"])
        repeated = np.append(found[trial, place[1:]], False)
        found[trial, place[after_gap & repeated]] = True
    return found


def weigh_held_array(chance: NDArray[np.float64], frames: int) -> NDArray[np.float64]:
    """Probability (n,) that equal frames were held.

    Of all frames a share h is held, and those are equal; any other equals the one before by
    `chance` (n,). Then h/(h + (1 − h) c) is the probability, and h its mean over all frames.

    >>> weigh_held_array(np.array([0.0, 0.0, 0.02]), 100).round(2).tolist()
    [1.0, 1.0, 0.57]
    """
    held = np.ones(len(chance))
    for _ in range(BUDGET.held_rounds):
        share = held.sum() / frames
        held = share / np.maximum(share + (1.0 - share) * chance, np.finfo(float).tiny)
    return held


def _expect_equals(angle: NDArray[np.float64], used: NDArray[np.bool_]) -> NDArray[np.float64]:
    """Chance (trial, joint, frame) to equal the frame before by rounding.

    Where a trial does not show it, the usual one of the joint's other trials; without those, 1.
    """
    chance = np.full(angle.shape, np.nan)
    for trial, joint in np.ndindex(angle.shape[:2]):
        place = np.flatnonzero(used[trial] & np.isfinite(angle[trial, joint]))
        chance[trial, joint, place] = _expect_along(angle[trial, joint, place])
    for column in np.moveaxis(chance, 1, 0):
        known = column[np.isfinite(column)]
        column[np.isnan(column)] = np.median(known) if known.size else 1.0
    return chance


def _expect_along(values: NDArray[np.float64]) -> NDArray[np.float64]:
    """Chance (n,) that a trial's angles (n,) equal their neighbours.

    Of the step that all have, or of a block's larger one, or of the blocks' beside it, for a block
    may have two; where a block shows none, of the trial's usual one.
    """
    blocks = _split_blocks(values)
    known = np.array([_expect_equal(part) for part in blocks])
    seen = known[np.isfinite(known)]
    known = np.where(np.isfinite(known), known, np.median(seen) if seen.size else np.nan)
    chance = np.repeat(maximum_filter1d(known, 3), [len(part) for part in blocks])
    return np.fmax(chance, _expect_equal(values))


def _split_blocks(values: NDArray[np.float64]) -> list[NDArray[np.float64]]:
    """Split angles (n,) into blocks that may each show a step."""
    return np.array_split(values, max(1, len(values) // (2 * DECISIONS.least_values)))


def _expect_equal(values: NDArray[np.float64]) -> float:
    """Chance that two neighbours (n,) are equal by rounding.

    It follows from the size of their differences. It is NaN where all are equal, or one step alone
    shows: what was held moves on, what was rounded returns to the same value.
    """
    change = np.abs(np.diff(values))
    change, distinct = change[change > 0], len(np.unique(values))
    if not change.size or (distinct < DECISIONS.least_distinct and change.size < distinct):
        return np.nan
    return float(min(1.0, find_step_array(values) / np.median(change)))


def find_rounding(angles: xr.Dataset, frames: xr.Dataset) -> NDArray[np.float64]:
    """Find the sd (joint,) [rad] of the angles' rounding.

    The usual step over √12; 0 where none shows.
    """
    angle = angles["joint_angle"].transpose("joint", "trial", "frame").values
    used = frames["used"].values
    steps = [[_find_usual_step(row[u & np.isfinite(row)])
              for row, u in zip(rows, used, strict=True)] for rows in angle]  # fmt: skip
    return np.median(steps, axis=1) / compute_step(1.0)


def compute_step[Sd: (float, NDArray[np.float64])](sd: Sd) -> Sd:
    """Step whose rounding has an sd: the width of an even spread.

    In the unit of the sd (…).

    >>> float(round(compute_step(1.0) ** 2, 9))
    12.0
    """
    return np.sqrt(12.0) * sd


def _find_usual_step(values: NDArray[np.float64]) -> float:
    """Step of a trial's angles (n,), or of most blocks."""
    step = find_step_array(values)
    return step or float(np.median([find_step_array(part) for part in _split_blocks(values)]))


def find_step_array(values: NDArray[np.float64]) -> float:
    """Find the step to which values were rounded.

    The values are (n,); it is 0 where no step shows.

    >>> find_step_array(0.5 * np.arange(30) // 1)
    1.0
    """
    if len(values) < DECISIONS.least_values:
        return 0.0
    return float(_find_step(np.ascontiguousarray(values)))


@compiled
def _find_step(values: NDArray) -> float:
    """The smallest gap between values (n,).

    It is 0 where not all gaps are its multiples.
    """
    gaps = np.diff(np.sort(values))
    gaps = gaps[gaps > 1e-12]
    if gaps.size == 0 or gaps.min() <= 1e-9:
        return 0.0
    ratio = gaps / gaps.min()
    away = np.abs(ratio - np.round(ratio)).max()
    return gaps.min() if away < 1e-3 * max(1.0, ratio.max()) else 0.0
