"""Load logs that end before the motion does."""

from collections.abc import Iterator, Sequence

import numpy as np

from softfinger.doubts.doubt import Doubt, name_trials
from softfinger.doubts.features import TrialFeatures

LATE_FRAMES, LATE_ROWS, LATE_SHARE = 5.0, 5.0, 0.02
WHOLE = 0.98  # of the recording, in the logs of the others
# A load taken off after the log's end explains so many times more, and then leaves little.
EXPLAINS, LEFT = 2.5, 0.4
NOTHING = 0.01  # of the largest load


def doubt_coverage(trials: Sequence[TrialFeatures]) -> Iterator[Doubt]:
    """Doubt logs that end too early.

    After a log's last row its last load is taken to act. A log of few rows may name only changes
    of the load, and then that is right. It is doubtful where the rows are samples, where the
    motion shows another load, or where the other trials' logs are as long as their recordings.
    """
    covered = np.array([(t.log_end - t.time[0]) / max(t.span, 1e-300) for t in trials])
    others_whole = covered.size > 2 and np.median(covered) >= WHOLE
    early = [t for t in trials if _ends_early(t) and (others_whole or _contradicts(t))]
    if not early:
        return
    first = early[0]
    names = [trial.name for trial in early]
    yield Doubt(
        "log_ends_early",
        f"the load log of {name_trials(names, len(trials))} ends "
        f"{first.time[-1] - first.log_end:.3g} s before the recording ({first.name}: at "
        f"{first.log_end:.4g} of {first.time[-1]:.4g} s), and its last load is taken to act until "
        "then; likely a log that was stopped or cut; add a row at the recording's end",
        tuple(names),
    )


def _ends_early(trial: TrialFeatures) -> bool:
    least = max(LATE_FRAMES * trial.interval, LATE_SHARE * trial.span)
    if np.isfinite(trial.log_interval):
        least = max(least, LATE_ROWS * trial.log_interval)
    acts = trial.time[0] < trial.log_end
    return bool(acts and trial.time[-1] - trial.log_end > least)


def _contradicts(trial: TrialFeatures) -> bool:
    if abs(trial.load[-1]) < NOTHING * trial.largest_load:
        return False  # nothing stays nothing
    released = trial.released < LEFT and trial.unexplained > EXPLAINS * trial.released
    return bool(np.isfinite(trial.log_interval) or released)
