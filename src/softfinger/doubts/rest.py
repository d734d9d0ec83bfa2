"""Doubtful angles at rest."""

from collections.abc import Iterator, Sequence

import numpy as np

from softfinger.doubts.doubt import Doubt, name_trials
from softfinger.doubts.features import TrialFeatures
from softfinger.doubts.groups import find_apart

LEAST_OFFSET_RAD, OF_MOTION = 0.25, 0.4
MOST_TRIALS = 0.25  # more of them are a session of their own
FAR_FROM_STRAIGHT_RAD = 1.0


def doubt_rest(trials: Sequence[TrialFeatures]) -> Iterator[Doubt]:
    """Doubt a joint's angle before any load."""
    if not np.isfinite([trial.rest for trial in trials]).any(axis=0).all():
        return
    rest = np.array([trial.rest for trial in trials])
    moved = np.median(np.abs([trial.moved for trial in trials]), axis=0)
    offset: dict[tuple[str, ...], list[int]] = {}
    for joint in range(rest.shape[1]):
        apart = find_apart(rest[:, joint], max(LEAST_OFFSET_RAD, OF_MOTION * moved[joint]))
        if apart.any() and apart.mean() <= MOST_TRIALS:
            names = tuple(trial.name for trial, a in zip(trials, apart, strict=True) if a)
            offset.setdefault(names, []).append(joint)
    for names, joints in offset.items():
        own = np.array([trial.name in names for trial in trials])
        by = [np.nanmedian(rest[own, j]) - np.nanmedian(rest[~own, j]) for j in joints]
        sizes = ", ".join(
            f"{size:+.2g} rad in joint {j + 1}" for size, j in zip(by, joints, strict=True)
        )
        yield Doubt(
            "offset",
            f"at rest {name_trials(names, len(trials))} differs from the others by {sizes}; likely "
            "an offset of the sensor, or a recording that began late; check its first frames",
            names,
            tuple(j + 1 for j in joints),
        )
    far = np.abs(np.nanmedian(rest, axis=0)) > FAR_FROM_STRAIGHT_RAD
    for joint in np.flatnonzero(far):
        yield Doubt(
            "far_from_straight",
            f"joint {joint + 1} rests at {np.nanmedian(rest[:, joint]):.2g} rad in all trials; 0 "
            "is the straight finger; likely another zero of the sensor: subtract it",
            (),
            (int(joint) + 1,),
        )
