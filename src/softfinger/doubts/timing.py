"""Doubtful clocks: intervals, spans, starts."""

from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from softfinger.doubts.doubt import Doubt, name_factor, name_trials
from softfinger.doubts.features import TrialFeatures
from softfinger.doubts.groups import find_apart

Array = NDArray[np.float64]
# Frame intervals [s] of a finger of several joints, which only a camera or encoders see.
INTERVALS = (5e-4, 5.0)
LEAST_RATIO = 1.15
SPANS_APART = (30.0, 1.2)  # a log so many times as long, by a unit's factor within that
UNITS_OF_TIME = (60.0, 1e3, 3600.0, 1e6)
OVERLAP = 0.1


def doubt_timing(trials: Sequence[TrialFeatures], started_at: Array) -> Iterator[Doubt]:
    """Doubt time stamps, load logs and starts."""
    yield from _doubt_intervals(trials)
    yield from _doubt_spans(trials)
    yield from _doubt_starts(trials, started_at)


def _doubt_intervals(trials: Sequence[TrialFeatures]) -> Iterator[Doubt]:
    interval = np.array([trial.interval for trial in trials])
    usual = float(np.median(interval))
    if trials[0].angle.shape[0] > 1 and not INTERVALS[0] <= usual <= INTERVALS[1]:
        other = 1e3 / usual if usual > 1 else 1e-3 / usual
        unit = "milliseconds" if usual > 1 else "kiloseconds, or minutes"
        yield Doubt(
            "frame_interval",
            f"the frames of all trials are {usual:.3g} s apart; expected {INTERVALS[0]:g} to "
            f"{INTERVALS[1]:g} s; likely the times are in {unit} ({other:.3g} frames "
            "per second then); check the column time_s",
        )
    apart = find_apart(np.log(interval), np.log(LEAST_RATIO))
    if apart.any():
        ratio = float(np.median(interval[apart]) / np.median(interval[~apart]))
        names = [t.name for t, a in zip(trials, apart, strict=True) if a]
        yield Doubt(
            "frame_interval_of_trials",
            f"the frames of {name_trials(names, len(trials))} are {ratio:.3g} times as far apart "
            f"as those of the others: {name_factor(ratio)}; likely a wrong unit or rate of its "
            "clock; check the column time_s",
            tuple(names),
        )


def _doubt_spans(trials: Sequence[TrialFeatures]) -> Iterator[Doubt]:
    wrong = []
    for trial in trials:
        ratio = float(np.ptp(trial.load_time)) / max(trial.span, 1e-12)
        near = min(UNITS_OF_TIME, key=lambda unit: abs(np.log(max(ratio, 1e-12) / unit)))
        if ratio > SPANS_APART[0] and abs(np.log(ratio / near)) < np.log(SPANS_APART[1]):
            wrong.append((trial.name, near))
    if wrong:
        names = [name for name, _ in wrong]
        yield Doubt(
            "span_of_load_log",
            f"the load log of {name_trials(names, len(trials))} is about {wrong[0][1]:g} times as "
            "long as the recording; likely its time is in another unit (milliseconds, minutes); "
            "check the column time_s of both",
            tuple(names),
        )


def _doubt_starts(trials: Sequence[TrialFeatures], started_at: Array) -> Iterator[Doubt]:
    known = np.flatnonzero(np.isfinite(started_at))
    order = known[np.argsort(started_at[known], kind="stable")]
    gap = np.diff(started_at[order])
    equal = np.flatnonzero(gap == 0)
    if equal.size:
        names = sorted({trials[order[k + m]].name for k in equal for m in (0, 1)})
        yield Doubt(
            "equal_starts",
            f"{name_trials(names, len(trials))} started at the same moment as another; likely a "
            "stamp that was copied; check the column started_at, from which rests are computed",
            tuple(names),
        )
    span = np.array([trial.span for trial in trials])[order[:-1]]
    early = np.flatnonzero((gap > 0) & (gap < (1.0 - OVERLAP) * span))
    if early.size:
        first = trials[order[early[0]]]
        names = [trials[order[k]].name for k in early]
        yield Doubt(
            "trials_overlap",
            f"{name_trials(names, len(trials))} still ran when the next one started: "
            f"{first.name} lasts {first.span:.3g} s, and the next starts {gap[early[0]]:.3g} s "
            f"after it ({name_factor(first.span / gap[early[0]])}); likely another unit of "
            "time_s, or a wrong started_at",
            tuple(names),
        )
