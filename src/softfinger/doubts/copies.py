"""Recordings that copy a part of each other."""

from collections.abc import Iterator, Sequence

import numpy as np

from softfinger.doubts.doubt import Doubt, list_briefly, name_trials
from softfinger.doubts.features import TrialFeatures

WINDOW = 8  # frames in a row whose changes no two recordings share by chance
LEAST_VALUES = 6  # different changes in a window: a joint at rest on a coarse sensor has fewer
SHARED = 0.3  # of a recording's windows
DIGITS = 7


def doubt_copies(trials: Sequence[TrialFeatures]) -> Iterator[Doubt]:
    """Doubt trials that repeat another's frame changes."""
    windows = [_list_windows(trial) for trial in trials]
    owners: dict[bytes, int] = {}
    copies: dict[int, set[int]] = {}
    for number, own in enumerate(windows):
        first = [owners[w] for w in own if w in owners]
        for owner in set(first):
            if first.count(owner) > SHARED * min(len(own), len(windows[owner])):
                copies.setdefault(owner, {owner}).add(number)
        for window in own:
            owners.setdefault(window, number)
    for members in copies.values():
        names = [trials[number].name for number in sorted(members)]
        yield Doubt(
            "copies",
            f"the recordings of {name_trials(names, len(trials))} are copies of each other "
            f"({list_briefly(names)}), whole or in part; likely one file that was saved under "
            "two names; give each trial its own recording",
            tuple(names),
        )


def _list_windows(trial: TrialFeatures) -> set[bytes]:
    change = np.round(np.diff(trial.angle, axis=1), DIGITS) + 0.0
    found = set()
    for start in range(0, change.shape[1] - WINDOW + 1):
        piece = change[:, start : start + WINDOW]
        if np.isfinite(piece).all() and np.unique(piece).size >= LEAST_VALUES:
            found.add(piece.tobytes())
    return found
