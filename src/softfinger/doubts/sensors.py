"""Doubtful sensors: frozen, clipped, quantised, wrapped, repeating."""

from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from softfinger.doubts.doubt import Doubt, name_trials
from softfinger.doubts.features import TrialFeatures

Array = NDArray[np.float64]
LEAST_FRAMES = 20
REPEATED = 0.55  # share of frames
STUCK = 0.15  # share of frames in one run
CLIPPED = 0.05  # share of frames at the extreme value
FEW_STEPS = 20.0  # of a quantised angle, over the motion
WRAP_RAD = 2.5  # between two frames
SMOOTH = 1e-6  # noise over the motion
LAST = 25.0  # sd of the noise
SPIKES = 3  # in all trials together

SAID = {
    "repeated_frames": (
        "repeats its frames: {:.0%} are equal to the one before; likely a camera or a bus slower "
        "than its log; keep the frames that are new"
    ),
    "stuck": (
        "repeats one value in {:.0%} of its frames in a joint; likely a sensor that froze, or "
        "is at the end of its range; leave these cells empty"
    ),
    "clipped": (
        "ends at one extreme value in {:.0%} of its frames; likely a sensor at the end of its "
        "range; leave these cells empty"
    ),
    "quantised": (
        "shows {:.0f} steps over its whole motion; likely rounded numbers or a coarse sensor; "
        "export more digits"
    ),
    "wrapped": (
        "jumps by {:.3g} rad from one frame to the next; likely an angle that wraps around at "
        "the end of a turn; unwrap it"
    ),
    "without_noise": (
        "has hardly any noise ({:.1g} of its motion); likely smoothed or computed; give the "
        "numbers as they were measured"
    ),
    "last_row": (
        "ends in a row that is {:.0f} sd of the noise off the rows before; likely a file that was "
        "cut short; remove the row"
    ),
}


def doubt_sensors(trials: Sequence[TrialFeatures], *, rotates: bool = True) -> Iterator[Doubt]:
    """Doubt every trial's numbers by themselves.

    Equal doubts become one.

    Only angles wrap around: `rotates` is false of a specimen.
    """
    found: dict[str, list[tuple[str, float]]] = {}
    for trial in trials:
        for what, size in examine_sensors(trial).items():
            if what == "wrapped" and not rotates:
                continue
            found.setdefault(what, []).append((trial.name, size))
    # Where other frames spring away as well, the last one was not cut short.
    if sum(count_spikes(trial) for trial in trials) >= SPIKES:
        found.pop("last_row", None)
    for what, members in found.items():
        names = [name for name, _ in members]
        size = float(np.median([size for _, size in members]))
        said = SAID[what].format(size)
        yield Doubt(what, f"{name_trials(names, len(trials))} {said}", tuple(names))


def count_spikes(trial: TrialFeatures) -> int:
    """Frames that spring away from both neighbours, which stay together."""
    angle = trial.angle
    away = angle[:, 1:-1] - 0.5 * (angle[:, :-2] + angle[:, 2:])
    limit = LAST * np.sqrt(1.5) * np.nan_to_num(trial.noise)[:, None]
    alone = np.abs(angle[:, 2:] - angle[:, :-2]) < 0.3 * np.abs(away)
    return int(((np.abs(away) > limit) & (limit > 0) & alone).any(axis=0).sum())


def examine_sensors(trial: TrialFeatures) -> dict[str, float]:
    """What is odd in a trial: doubt → size."""
    angle = trial.angle
    if angle.shape[1] < LEAST_FRAMES:
        return {}
    found: dict[str, float] = {}
    steps = _count_steps(angle)
    if steps is not None:
        found["quantised"] = steps
    if trial.stale > REPEATED and steps is None:
        found["repeated_frames"] = trial.stale
    elif steps is None:
        found |= _find_plateaus(angle)
    leap = np.abs(np.diff(angle, axis=1))
    if np.nanmax(leap, initial=0.0) > WRAP_RAD:
        found["wrapped"] = float(np.nanmax(leap))
    return found | _find_odd_noise(trial, steps)


def _count_steps(angle: Array) -> float | None:
    """Steps of the joint that moves most."""
    widest = int(np.nanargmax(np.nanmax(angle, axis=1) - np.nanmin(angle, axis=1)))
    values = angle[widest][np.isfinite(angle[widest])]
    levels = np.unique(np.round(values, 9))
    if levels.size < 2 or levels.size > 0.25 * values.size:
        return None
    steps = float((levels[-1] - levels[0]) / np.diff(levels).min())
    return steps if steps < FEW_STEPS else None


def _find_plateaus(angle: Array) -> dict[str, float]:
    """Long runs or repeated extremes in a noisy joint."""
    found: dict[str, float] = {}
    for values in angle:
        seen = values[np.isfinite(values)]
        if seen.size < LEAST_FRAMES:
            continue
        run = _find_longest_run(seen[1:] == seen[:-1]) / seen.size
        at_end = max(float((seen == end).mean()) for end in (seen.max(), seen.min()))
        fine = np.unique(seen).size > 0.9 * (1.0 - max(run, at_end)) * seen.size
        if not fine:
            continue
        if run > STUCK:
            found["stuck"] = max(run, found.get("stuck", 0.0))
        elif at_end > CLIPPED:
            found["clipped"] = max(at_end, found.get("clipped", 0.0))
    return found


def _find_longest_run(same: NDArray[np.bool_]) -> int:
    edges = np.flatnonzero(np.diff(np.concatenate([[0], same.astype(int), [0]])))
    return int(np.max(edges[1::2] - edges[::2], initial=0))


def _find_odd_noise(trial: TrialFeatures, steps: float | None) -> dict[str, float]:
    noise = np.nan_to_num(trial.noise)
    reach = np.nanmax(trial.angle, axis=1) - np.nanmin(trial.angle, axis=1)
    found: dict[str, float] = {}
    share = noise / np.maximum(reach, 1e-300)
    fine = np.unique(trial.angle[0]).size > 0.5 * trial.angle.shape[1]
    if fine and steps is None and trial.stale < 0.3 and (share < SMOOTH).all():
        found["without_noise"] = float(share.max())
    end = trial.angle[:, -4:]
    if np.isfinite(end).all() and (noise > 0).all():
        expected = 2.0 * end[:, 2] - end[:, 1]
        off = np.abs(end[:, 3] - expected) / (np.sqrt(6.0) * noise)
        quiet = np.abs(end[:, 2] - 2.0 * end[:, 1] + end[:, 0]) < 5.0 * np.sqrt(6.0) * noise
        if (off > LAST).any() and quiet.all():
            found["last_row"] = float(off.max())
    return found
