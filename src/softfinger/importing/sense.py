"""Whether recordings move with their load."""

from collections.abc import Sequence

import numpy as np

from softfinger.importing.build import ImportedTrial


def find_sign(trials: Sequence[ImportedTrial]) -> int:
    """Sign that makes trials move with their load.

    It is −1 where more trials move against their load than with it, else 1.

    Where the load changes, motion and load vary together or against each other; where it does not,
    or is not known, the late motion is compared with the first.
    """
    senses = [_find_sense(trial) for trial in trials]
    return -1 if senses.count(-1) > senses.count(1) else 1


def _find_sense(trial: ImportedTrial) -> int:
    motion = _sum_motion(trial)
    seen = np.isfinite(motion)
    if seen.sum() < 2:
        return 0
    motion, time = motion[seen], trial.time[seen]
    load = np.ones(time.size)
    if trial.load.size:
        load = np.interp(time, trial.load_time, trial.load)
    if np.ptp(load) > 0:
        together = np.sum((motion - motion.mean()) * (load - load.mean()))
    else:
        late = motion[-max(1, motion.size // 5) :]
        together = (np.median(late) - motion[0]) * load[-1]
    return int(np.sign(together))


def _sum_motion(trial: ImportedTrial) -> np.ndarray:
    """Sum of angles (frame,), or a chain's bending."""
    if not trial.points:
        return trial.motion.sum(axis=1)
    place = trial.motion.reshape(len(trial.time), -1, 2)
    first, last = place[:, 1] - place[:, 0], place[:, -1] - place[:, -2]
    angle = np.arctan2(-last[:, 1], last[:, 0]) - np.arctan2(-first[:, 1], first[:, 0])
    seen = np.isfinite(angle)
    angle[seen] = np.unwrap(angle[seen])
    return angle
