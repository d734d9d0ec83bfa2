"""Trials of many times the others' gain."""

from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from softfinger.doubts.doubt import Doubt, name_factor, name_trials
from softfinger.doubts.features import TrialFeatures
from softfinger.doubts.groups import find_apart
from softfinger.doubts.noise import bound_noise
from softfinger.doubts.together import begins_late
from softfinger.doubts.units import doubt_units

Array = NDArray[np.float64]
LEAST_RATIO = 2.5  # below it stiffness may well differ
LIKE_LOADS = 1.5  # loads of a ratio up to it are alike
NOISE_RATIO = 8.0


def doubt_scale(trials: Sequence[TrialFeatures]) -> Iterator[Doubt]:
    """Doubt units, gains and noise, by joint and together."""
    units = list(doubt_units(trials))
    yield from units
    explained = {name for doubt in units for name in doubt.trials}
    trials = [trial for trial in trials if trial.name not in explained]
    if trials:
        yield from _doubt_noise(trials)
    trials = [trial for trial in trials if not begins_late(trial)]  # their gain is unknown
    if not trials:
        return
    gain = np.array([np.abs(trial.gain) for trial in trials])
    load = _log(np.array([trial.largest_load for trial in trials]))
    moved = _log(np.array([np.abs(trial.moved).max() for trial in trials]))
    total = _log(gain.sum(axis=1))
    apart = find_apart(total, np.log(LEAST_RATIO))
    if apart.any():
        yield from _describe(trials, apart, total, load, moved)
    else:
        for joint in range(gain.shape[1] if gain.shape[1] > 1 else 0):
            own = _log(gain[:, joint])
            apart = find_apart(own, np.log(LEAST_RATIO * 2.0))
            if apart.any():
                yield _describe_joint(trials, apart, own, joint + 1)


def _describe(
    trials: Sequence[TrialFeatures],
    apart: NDArray[np.bool_],
    gain: Array,
    load: Array,
    moved: Array,
) -> Iterator[Doubt]:
    ratio, loads, motions = (_compare(values, apart) for values in (gain, load, moved))
    wrong_load = abs(loads) > np.log(LIKE_LOADS)
    # A material may answer another load otherwise, but hardly with the same motion.
    if wrong_load and abs(motions) > 0.35 * abs(loads):
        return
    what = "load log" if wrong_load else "angles, or its load log"
    names = [t.name for t, a in zip(trials, apart, strict=True) if a]
    yield Doubt(
        "scale_of_trials",
        f"{name_trials(names, len(trials))} moved {np.exp(ratio):.3g} times as far per load as the "
        f"others: {name_factor(np.exp(ratio))}; likely a wrong unit of the {what}; compare the "
        "units of these files with those of the others",
        tuple(names),
    )


def _describe_joint(
    trials: Sequence[TrialFeatures], apart: NDArray[np.bool_], gain: Array, joint: int
) -> Doubt:
    ratio = np.exp(_compare(gain, apart))
    names = [t.name for t, a in zip(trials, apart, strict=True) if a]
    return Doubt(
        "scale_of_joint",
        f"joint {joint} of {name_trials(names, len(trials))} moved {ratio:.3g} times as far per "
        f"load as in the others: {name_factor(ratio)}; likely a stuck sensor, or a wrong unit; "
        "check "
        f"column q{joint}_rad",
        tuple(names),
        (joint,),
    )


def _doubt_noise(trials: Sequence[TrialFeatures]) -> Iterator[Doubt]:
    noise = np.array([bound_noise(trial.noise, trial.resolution) for trial in trials])
    apart = find_apart(_log(noise.mean(axis=1)), np.log(NOISE_RATIO))
    if apart.any():
        ratio = np.exp(_compare(_log(noise.mean(axis=1)), apart))
        names = [t.name for t, a in zip(trials, apart, strict=True) if a]
        yield Doubt(
            "noise_of_trials",
            f"{name_trials(names, len(trials))} has {ratio:.3g} times the noise of the others: "
            f"{name_factor(ratio)}; likely another sensor, filter or unit; check how these trials "
            "were recorded",
            tuple(names),
        )


def _compare(values: Array, apart: NDArray[np.bool_]) -> float:
    return float(np.nanmedian(values[apart]) - np.nanmedian(values[~apart]))


def _log(values: Array) -> Array:
    return np.log(np.where(values > 0, values, np.nan))
