"""Trials whose rest was subtracted, beside others that keep it."""

from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from softfinger.doubts.doubt import Doubt, name_trials
from softfinger.doubts.features import TrialFeatures

Array = NDArray[np.float64]
MOST_FRAMES = 200  # of whose first so many the mean may have been subtracted
CHANCE = 1e-6  # of a rest so near to zero
KEPT = 8.0  # sd of a rest's error by which the others rest away from zero
FIRST = 5  # frames at a recording's start
FINE = 0.01  # of the noise: coarser angles have means of zero by chance
COMMON = 0.02  # share of angles that are exactly zero, above which a first one is no surprise


def doubt_zeroed(trials: Sequence[TrialFeatures]) -> Iterator[Doubt]:
    """Doubt rests that are zero, where others are not."""
    zeroed = [is_zeroed(trial) for trial in trials]
    kept = [not z and _rests_away(trial) for trial, z in zip(trials, zeroed, strict=True)]
    if not any(zeroed) or sum(kept) <= 0.5 * (len(trials) - sum(zeroed)):
        return
    names = [trial.name for trial, z in zip(trials, zeroed, strict=True) if z]
    rest = [np.abs(start_of(t)).max() for t, k in zip(trials, kept, strict=True) if k]
    yield Doubt(
        "zeroed",
        f"in {name_trials(names, len(trials))} every joint begins at exactly 0 rad, or its first "
        f"frames have that mean; the others begin up to {max(rest):.2g} rad away from 0; likely "
        "each of these trials was set to zero at its start; treat all trials alike, best without "
        "subtracting anything",
        tuple(names),
    )


def is_zeroed(trial: TrialFeatures) -> bool:
    """Whether the first frame, or a mean of the first, is zero.

    A mean of noise is near zero by chance; all joints' means at once, so near, are not.
    """
    angle = trial.angle
    noise = np.nan_to_num(trial.noise)
    if not np.isfinite(angle[:, 0]).all() or not (noise > 0).all():
        return False
    seen = angle[np.isfinite(angle)]
    if (angle[:, 0] == 0.0).all():
        return bool((seen == 0.0).mean() < COMMON)
    if (trial.resolution > FINE * noise).any():
        return False
    first = angle[:, :MOST_FRAMES]
    first = first[:, : int(np.argmin(np.isfinite(np.append(first.sum(axis=0), np.nan))))]
    count = np.arange(1, first.shape[1] + 1)
    mean = np.abs(np.cumsum(first, axis=1)) / count
    near = (CHANCE / MOST_FRAMES) ** (1.0 / len(angle))
    middle = np.abs(trial.rest)
    means = (mean < near * noise[:, None] / np.sqrt(count)).all(axis=0).any()
    return bool(means or (middle < near * noise).all())


def start_of(trial: TrialFeatures) -> Array:
    """Mean of the first frames (joint,) [rad]."""
    first = trial.angle[:, :FIRST]
    seen = np.isfinite(first)
    return np.where(seen, first, 0.0).sum(axis=1) / np.maximum(seen.sum(axis=1), 1)


def _rests_away(trial: TrialFeatures) -> bool:
    return bool((np.abs(start_of(trial)) > KEPT * np.nan_to_num(trial.noise)).any())
