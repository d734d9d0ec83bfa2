"""Joints whose unit is not that of the others."""

from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from softfinger.doubts.doubt import OF_ANGLES, Doubt, name_factor, name_trials
from softfinger.doubts.features import TrialFeatures
from softfinger.doubts.groups import find_apart
from softfinger.doubts.noise import bound_noise

Array = NDArray[np.float64]
FAR = np.log(8.0)  # of one joint from every other, in noise and in motion
ALIKE = np.log(4.0)  # between the two: a unit multiplies both
SPREAD = 0.3  # of the factor, in its logarithm: noise is not equal in all joints
# Between trials the noise of a joint over that of the others hardly differs.
APART, MOVED, ALIKE_APART = np.log(2.5), np.log(1.6), np.log(2.5)


def doubt_units(trials: Sequence[TrialFeatures]) -> Iterator[Doubt]:
    """Doubt joints with many times others' noise and motion.

    A unit multiplies both; a stiff joint moves less with the same noise, and a dead one too.
    """
    if trials[0].angle.shape[0] < 2:
        return
    noise = _log(np.array([bound_noise(trial.noise, trial.resolution) for trial in trials]))
    moved = _log(np.abs([trial.moved for trial in trials]))
    yield from _doubt_all(noise, moved)
    found = [_compare_trials(noise, moved, joint) for joint in range(noise.shape[1])]
    # One joint's unit shifts it against the others, and these a little against it.
    joint = max(range(len(found)), key=lambda j: abs(found[j][1]))
    apart, ratio = found[joint]
    if apart.any():
        names = [t.name for t, a in zip(trials, apart, strict=True) if a]
        ratio = float(np.exp(ratio))
        yield _describe(joint + 1, ratio, "in the others", names, len(trials))


def _doubt_all(noise: Array, moved: Array) -> Iterator[Doubt]:
    middle = [np.median(values[np.isfinite(values).all(axis=1)], axis=0, keepdims=True)
              for values in (noise, moved) if np.isfinite(values).all(axis=1).any()]  # fmt: skip
    if len(middle) < 2:
        return
    by_noise, by_motion = (m[0][:, None] - m[0][None, :] for m in middle)
    count = len(by_noise)
    for joint in range(count):
        others = np.arange(count) != joint
        a, b = by_noise[joint, others], by_motion[joint, others]
        for sign in (1.0, -1.0) if count > 2 else (1.0,):
            far = (sign * a > FAR) & (sign * b > FAR) & (np.abs(a - b) < ALIKE)
            if far.all():
                ratio = float(np.exp(np.median(a)))
                yield _describe(joint + 1, ratio, "in the other joints", [], 0)


def _compare_trials(noise: Array, moved: Array, joint: int) -> tuple[NDArray[np.bool_], float]:
    """Trials in which a joint's noise and motion are another unit's, and its logarithm."""
    others = np.arange(noise.shape[1]) != joint
    by_noise, by_motion = (v[:, joint] - v[:, others].mean(axis=1) for v in (noise, moved))
    apart = find_apart(by_noise, APART)
    if not apart.any():
        return apart, 0.0
    a, b = (np.nanmedian(v[apart]) - np.nanmedian(v[~apart]) for v in (by_noise, by_motion))
    if not (a * b > 0 and abs(b) > MOVED and abs(a - b) < ALIKE_APART):
        return np.zeros_like(apart), 0.0
    return apart, float(a)


def _describe(joint: int, ratio: float, than: str, names: list[str], of: int) -> Doubt:
    where = f" of {name_trials(names, of)}" if names else ""
    return Doubt(
        "unit_of_joint",
        f"joint {joint}{where} has {ratio:.3g} times the noise, and about as many times the "
        f"motion, as {than}: {name_factor(ratio, SPREAD, OF_ANGLES)}; likely another unit in its "
        f"column; check q{joint}_rad",
        tuple(names),
        (joint,),
    )


def _log(values: Array) -> Array:
    return np.log(np.where(values > 0, values, np.nan))
