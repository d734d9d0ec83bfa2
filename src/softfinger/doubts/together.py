"""Loads and motions that do not belong together."""

from collections.abc import Iterator, Sequence

import numpy as np

from softfinger.doubts.doubt import Doubt, name_trials
from softfinger.doubts.features import TrialFeatures
from softfinger.doubts.groups import find_apart

# A shift is doubted where it explains so many times more, and then leaves little.
EXPLAINS, LEFT = 2.5, 0.4
# A late motion that is slow is an actuator's lag; one that is quick once it began is a clock's.
PACES = 3.0
UNRELATED, LEAST_RATIO = 0.6, 3.0
MUCH = 0.3  # of the usual motion: less may be chance under a load below some threshold
LATE_FRAMES, LATE_SHARE = 5.0, 0.01
CLEAR, FAINT = 20.0, 5.0  # motion in sd of the noise


def doubt_together(trials: Sequence[TrialFeatures]) -> Iterator[Doubt]:
    """Doubt shifts, and motions without their load."""
    late = [trial for trial in trials if begins_late(trial)]
    if late:
        yield _describe_late(late, len(trials))
    shifted = [trial for trial in trials if _is_shifted(trial) and trial not in late]
    if shifted:
        yield _describe_shift(shifted, len(trials))
    idle = [trial for trial in trials if trial.largest_load == 0.0 and _moves(trial, CLEAR)]
    if idle:
        first = idle[0]
        yield Doubt(
            "motion_without_load",
            f"{name_trials([t.name for t in idle], len(trials))} moved while its load was 0: the "
            f"recording lasts from {first.time[0]:.3g} to {first.time[-1]:.3g} s, the load acts "
            f"from {first.loaded_at:.3g} s; likely two clocks; check both columns time_s",
            tuple(t.name for t in idle),
        )
    yield from _doubt_stillness(trials)
    rest = [trial for trial in trials if trial not in [*late, *shifted, *idle]]
    yield from _doubt_unexplained(rest, len(trials))


def begins_late(trial: TrialFeatures) -> bool:
    """Whether the recording begins after its load."""
    after = trial.time[0] - trial.loaded_at
    return bool(after > max(LATE_FRAMES * trial.interval, LATE_SHARE * trial.span))


def _describe_late(late: list[TrialFeatures], of: int) -> Doubt:
    first = late[0]
    return Doubt(
        "begins_late",
        f"the recording of {name_trials([t.name for t in late], of)} begins "
        f"{first.time[0] - first.loaded_at:.3g} s after its load, without the finger's rest; "
        "likely the recording and the load log have different zeros of time; check "
        "their columns time_s",
        tuple(trial.name for trial in late),
    )


def _is_shifted(trial: TrialFeatures) -> bool:
    if trial.shift == 0.0 or trial.shifted > LEFT or not _moves(trial, CLEAR):
        return False
    quick = trial.shift < 0 or trial.shift > PACES * trial.pace
    return quick and trial.unexplained > EXPLAINS * trial.shifted


def _describe_shift(shifted: list[TrialFeatures], of: int) -> Doubt:
    names = [trial.name for trial in shifted]
    shift = float(np.median([trial.shift for trial in shifted]))
    word = "after" if shift > 0 else "before"
    return Doubt(
        "load_shifted",
        f"{name_trials(names, of)} moved about {abs(shift):.2g} s {word} its load, as if the "
        "load came then; likely the recording and the load log have different zeros of time; check "
        "their columns time_s",
        tuple(names),
    )


def _doubt_stillness(trials: Sequence[TrialFeatures]) -> Iterator[Doubt]:
    moving = [trial for trial in trials if _moves(trial, CLEAR)]
    if len(moving) < 2:
        return
    usual = float(np.median([trial.largest_load for trial in moving]))
    still = [t for t in trials if not _moves(t, FAINT) and t.largest_load > 0.7 * usual]
    if still:
        names = [trial.name for trial in still]
        yield Doubt(
            "load_without_motion",
            f"{name_trials(names, len(trials))} did not move under its load, as the others did; "
            "likely a wire that came off, or a recording of another moment; check its recording",
            tuple(names),
        )


def _doubt_unexplained(trials: Sequence[TrialFeatures], of: int) -> Iterator[Doubt]:
    clear = [trial for trial in trials if _moves(trial, CLEAR)]
    if not clear:
        return
    reach = np.array([np.abs(trial.moved).max() for trial in clear])
    clear = [t for t, r in zip(clear, reach, strict=True) if r > MUCH * np.median(reach)]
    if not clear:  # motions without a size: no frame after the load
        return
    left = np.array([trial.unexplained for trial in clear])
    apart = find_apart(np.log(left + 1e-9), np.log(LEAST_RATIO)) & (left > 0.3)
    if np.median(left) > UNRELATED:
        apart = left > UNRELATED
    if not apart.any():
        return
    names = [trial.name for trial, a in zip(clear, apart, strict=True) if a]
    yield Doubt(
        "load_unrelated",
        f"the load of {name_trials(names, of)} leaves {np.median(left[apart]):.0%} of the motion "
        f"unexplained ({np.median(left):.0%} is usual here); likely the log of another trial, "
        "another clock rate, or a reversed recording; check its load log",
        tuple(names),
    )


def _moves(trial: TrialFeatures, times: float) -> bool:
    """Whether some joint moves beyond its noise."""
    reach = np.nanpercentile(trial.angle, 98, axis=1) - np.nanpercentile(trial.angle, 2, axis=1)
    return bool((reach > times * np.nan_to_num(trial.noise)).any())
