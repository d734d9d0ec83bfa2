"""Gaps of a recording that somebody bridged."""

from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from softfinger.doubts.doubt import Doubt, name_trials
from softfinger.doubts.features import TrialFeatures

Array = NDArray[np.float64]
LEAST_BENDS = 6  # inner frames of a straight line
STRAIGHT = 0.02  # of the noise: a bend below it is none
BESIDE = 10  # frames on either side, which must show noise
LEAST_TURNS = 3  # changes of the bend's sign there: noise turns, a motion does not
CLEARER = 50.0  # the noise beside a line over the line's own
CHANCE = 1e-6  # of such a line in noise


def doubt_bridged(trials: Sequence[TrialFeatures]) -> Iterator[Doubt]:
    """Doubt straight lines between noisy stretches."""
    found: list[tuple[str, float, float]] = []
    joints: set[int] = set()
    for trial in trials:
        lines = [find_lines(trial.time, values, n) for values, n in _list_joints(trial)]
        share = max((float(line.mean()) for line in lines), default=0.0)
        if share > 0.0:
            first = min(int(np.argmax(line)) for line in lines if line.any())
            found.append((trial.name, share, float(trial.time[first])))
            joints |= {j + 1 for j, line in enumerate(lines) if line.any()}
    if found:
        names = [name for name, *_ in found]
        name, share, at = max(found, key=lambda one: one[1])
        whole = len(joints) == trials[0].angle.shape[0]
        yield Doubt(
            "bridged_gaps",
            f"in {name_trials(names, len(trials))} straight lines without noise lie between noisy "
            f"frames: {share:.1%} of {name}, the first at {at:.4g} s; likely gaps that were "
            "filled by interpolation; leave these cells empty",
            tuple(names),
            () if whole else tuple(sorted(joints)),
        )


def _list_joints(trial: TrialFeatures) -> Iterator[tuple[Array, float]]:
    for values, noise in zip(trial.angle, trial.noise, strict=True):
        yield values, float(noise) if np.isfinite(noise) else 0.0


def find_lines(time: Array, values: Array, noise: float) -> NDArray[np.bool_]:
    """Inner frames (frame,) of straight lines in noise.

    The lines are straight in time or, as a table's editor draws them, in the number of the row.
    """
    inside = np.zeros(values.size, bool)
    if noise <= 0.0 or values.size < LEAST_BENDS + 2 * BESIDE:
        return inside
    before, after = np.diff(time)[:-1], np.diff(time)[1:]
    bend = values[2:] - 2.0 * values[1:-1] + values[:-2]
    share = before / np.maximum(before + after, 1e-300)
    in_time = 2.0 * ((1.0 - share) * values[:-2] + share * values[2:] - values[1:-1])
    limit = STRAIGHT * np.sqrt(6.0) * noise
    moves = values[2:] != values[:-2]
    flat = (np.abs(bend) < limit) & moves
    flat_in_time = (np.abs(in_time) < limit) & moves
    for straight, size in ((flat, bend), (flat_in_time, in_time)):
        for first, last in _list_runs(straight):
            if _is_line(straight, size, first, last):
                inside[first + 1 : last + 1] = True
    return inside


def _list_runs(straight: NDArray[np.bool_]) -> list[tuple[int, int]]:
    edges = np.flatnonzero(np.diff(np.concatenate([[0], straight.astype(np.int8), [0]])))
    runs = edges.reshape(-1, 2)
    return [(int(a), int(b)) for a, b in runs[np.diff(runs, axis=1)[:, 0] >= LEAST_BENDS]]


def _is_line(straight: NDArray[np.bool_], bend: Array, first: int, last: int) -> bool:
    """Whether noise surrounds a straight run, which chance does not make."""
    length = last - first
    others = (np.count_nonzero(straight) - length) / max(straight.size - length, 1)
    if straight.size * max(others, STRAIGHT) ** length > CHANCE:
        return False
    own = float(np.median(np.abs(bend[first:last])))  # at an end of the line noise may be faint
    for beside in (
        bend[max(first - 1 - BESIDE, 0) : first - 1],
        bend[last + 1 : last + 1 + BESIDE],
    ):
        seen = beside[np.isfinite(beside) & (beside != 0.0)]
        if seen.size < BESIDE // 2 or np.median(np.abs(seen)) < CLEARER * own:
            return False
        if np.count_nonzero(np.diff(np.sign(seen))) < LEAST_TURNS:
            return False
    return True
