"""Stretches of recordings that occur twice."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Whole = NDArray[np.int64]
CELLS = 24  # changes in a row that no two stretches of a recording share by chance
SHORTEST = 8  # frames of a window, however many joints there are
LEAST_VALUES = 6  # different changes in a window: a joint at rest on a coarse sensor has fewer
ROUNDED = 4  # steps by which the changes along a straight line may differ
STEPS_PER_RAD = 1e7
LARGEST = 1e10  # steps; a larger change is no angle
MOST_RUNS = 2000  # of a recording, the longest: a coarse sensor at rest has very many
MIXERS = (0x9E3779B97F4A7C15, 0xBF58476D1CE4E5B9)


@dataclass(frozen=True)
class Stretch:
    """Frames of a recording that are those of another, or its own, earlier ones.

    Attributes
    ----------
    first, second : int
        Numbers of the recordings; equal where one repeats itself.
    from_frame, at_frame : int
        Where the stretch begins in either.
    frames : int
        How long it is.
    """

    first: int
    second: int
    from_frame: int
    at_frame: int
    frames: int


def find_stretches(recordings: Sequence[Array]) -> Iterator[Stretch]:
    """Stretches of equal changes of angles (joint, frame).

    A constant offset between them makes no difference.
    """
    if not recordings:
        return
    length = max(SHORTEST, -(-CELLS // len(recordings[0])))
    keys = [_hash_windows(angle, length) for angle in recordings]
    sizes = [key.size for key in keys]
    starts = np.concatenate([[0], np.cumsum(sizes)])
    earlier = _find_earlier(np.concatenate(keys))
    for number in range(len(recordings)):
        own = earlier[starts[number] : starts[number + 1]]
        for at, source, windows in _list_runs(own):
            first = int(np.searchsorted(starts, source, side="right")) - 1
            begin = int(source - starts[first])
            if first == number and at - begin < length:
                continue  # it overlaps itself: a constant slope
            if _is_particular(recordings[number][:, at : at + length + 1]):
                yield Stretch(first, number, begin, at, windows + length)


def _hash_windows(angle: Array, length: int) -> NDArray[np.uint64]:
    """A number for every window of frame changes; 0 where a cell is missing."""
    count = angle.shape[1] - length
    if count <= 0:
        return np.zeros(0, np.uint64)
    changes = np.zeros(angle.shape[1] - 1, np.uint64)
    known = np.ones(changes.size, bool)
    for joint, values in enumerate(angle):
        steps = np.rint(np.diff(values) * STEPS_PER_RAD)
        known &= np.abs(steps) < LARGEST
        whole = np.where(known, steps, 0.0).astype(np.int64).view(np.uint64)
        changes = _mix(changes + _mix(whole + np.uint64(joint + 1)))
    windows, whole_windows = np.zeros(count, np.uint64), np.ones(count, bool)
    for k in range(length):
        windows = _mix(windows + changes[k : k + count])
        whole_windows &= known[k : k + count]
    return np.where(whole_windows, windows, np.uint64(0))


def _mix(number: NDArray[np.uint64]) -> NDArray[np.uint64]:
    for mixer in MIXERS:
        number = (number ^ (number >> np.uint64(29))) * np.uint64(mixer)
    return number ^ (number >> np.uint64(32))


def _find_earlier(keys: NDArray[np.uint64]) -> Whole:
    """Place of the first equal key before each, or −1."""
    order = np.argsort(keys, kind="stable")
    ordered = keys[order]
    new = np.ones(keys.size, bool)
    new[1:] = ordered[1:] != ordered[:-1]
    earlier = np.full(keys.size, -1, np.int64)
    again = np.flatnonzero(~new & (ordered != 0))
    leader = np.flatnonzero(new)
    earlier[order[again]] = order[leader[np.searchsorted(leader, again, side="right") - 1]]
    return earlier


def _list_runs(earlier: Whole) -> Iterator[tuple[int, int, int]]:
    """Runs of windows whose originals follow each other: (at, original, windows)."""
    at = np.flatnonzero(earlier >= 0)
    if not at.size:
        return
    breaks = (np.diff(at) != 1) | (np.diff(earlier[at]) != 1)
    first = np.concatenate([[0], np.flatnonzero(breaks) + 1])
    size = np.diff(np.append(first, at.size))
    for run in np.sort(np.argsort(-size, kind="stable")[:MOST_RUNS]):
        begin = at[first[run]]
        yield int(begin), int(earlier[begin]), int(size[run])


def _is_particular(piece: Array) -> bool:
    """Whether changes are many and no straight line's."""
    steps = np.rint(np.diff(piece, axis=1) * STEPS_PER_RAD)
    return np.unique(steps).size >= LEAST_VALUES and bool(np.ptp(steps, axis=1).max() > ROUNDED)
