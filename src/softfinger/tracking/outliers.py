"""Repeated frames, and samples outside the motion."""

from collections.abc import Iterator

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view
from scipy.ndimage import median_filter

_LONGEST_EXCURSION = 15  # frames
_BASELINE_WINDOWS = (2 * _LONGEST_EXCURSION + 1, 15, 7)  # distinct frames
_NEIGHBOURS = 3  # steps of the motion on either side
_ABRUPT = 8.0  # how much larger than these the steps away and back are
_ABOVE_NOISE = 8.0  # standard deviations
_RETURN = 0.25  # how near to where it left, in units of the step
_AFTER_LOAD = (-1.5, 3.5)  # frames about a jump of the load at which a motion may begin
_NEARBY_CHANGES = 31
_PIECE = 50_000  # windows that are sorted at a time
_ALIKE = 1e-4  # difference of two changes that are the same, in the typical change
_MOST_ALIKE = 0.3  # share of changes that have a twin nearby, above which values are rounded


def find_stale_array(angle: np.ndarray) -> np.ndarray:
    """Find frames that repeat the one before.

    The camera is then slower than its log.

    Equal values in a row prove a repeated frame only where the recording resolves much finer
    changes than those it shows; where it is coarsely rounded, changes nearby are equal to each
    other as well, and equal values are no surprise.

    Parameters
    ----------
    angle : (channel, frame)
        Joint angles, or marker coordinates; NaN = missing.

    Returns
    -------
    (frame,) bool

    Examples
    --------
    >>> find_stale_array(np.array([[1.0, 2.013, 2.013, 1.5, 1.501]]))
    array([False, False,  True, False, False])
    >>> find_stale_array(np.array([[1.0, 2.0, 2.0, 1.0, 2.0]]))
    array([False, False, False, False, False])
    """
    change = np.diff(angle, axis=1)
    np.abs(change, out=change)
    gone = np.isnan(angle[:, 1:]) & np.isnan(angle[:, :-1])
    equal = ((change == 0) | gone).all(axis=0) & (change == 0).any(axis=0)
    fine = np.zeros_like(equal)
    for channel in change:
        fine |= _resolves_finely(channel)
    return np.concatenate([[False], equal & fine])


def _resolves_finely(change: np.ndarray) -> np.ndarray:
    """Whether changes are unrounded (change,) bool."""
    at = np.flatnonzero(np.isfinite(change) & (change > 0))
    if at.size < 2:
        return np.full(change.size, at.size > 0)
    size = min(_NEARBY_CHANGES, at.size)
    windows = sliding_window_view(change[at], size)
    alike = np.empty(len(windows))
    for start in range(0, len(windows), _PIECE):  # sorted at once, they would fill the memory
        nearby = np.sort(windows[start : start + _PIECE], axis=1)
        twins = np.diff(nearby, axis=1) < _ALIKE * np.median(nearby, axis=1)[:, None]
        alike[start : start + _PIECE] = twins.mean(axis=1)
    first = (np.searchsorted(at, np.arange(change.size)) - size // 2).clip(0, len(windows) - 1)
    return alike[first] < _MOST_ALIKE


def find_jumps_array(time: np.ndarray, value: np.ndarray, load_jumps: np.ndarray) -> np.ndarray:
    """Find excursions of a tracker.

    They are samples that leave the motion at once, and return at once.

    Candidates are runs of at most 15 frames that differ from a running median (over 31, 15 or 7
    distinct frames) by more than eight noise standard deviations and more than the motion makes
    that median uncertain. A candidate is an excursion where
    the steps into and out of it (i) lead back to where it left, (ii) exceed eight times those of
    the remaining motion, of which the three before and the three after it are taken and a single
    large one is allowed, and (iii) it does not begin at a jump of the load. A ring after a step,
    however fast, fails (ii): what remains of it moves as well. A step of the finger is no
    candidate: it does not return.

    Parameters
    ----------
    time : (frame,) [s]
    value : (frame,) or (frame, axis)
        A joint angle, or a marker's place; NaN = missing.
    load_jumps : (jump,) [s]

    Returns
    -------
    (frame,) bool

    Examples
    --------
    >>> value = np.sin(np.arange(40) / 40)
    >>> value[[17, 18]] -= 3.0
    >>> np.flatnonzero(find_jumps_array(np.arange(40.0), value, np.array([])))
    array([17, 18])
    """
    value = value.reshape(len(value), -1)
    interval = float(np.median(np.diff(time[np.isfinite(time)])))
    jumps = np.zeros(len(value), bool)
    for window in _BASELINE_WINDOWS:
        seen = np.flatnonzero(np.isfinite(value).all(axis=1) & ~jumps)
        for run in _list_excursions(value, seen, window):
            begin = (time[run[0]] - load_jumps) / interval
            if not ((begin >= _AFTER_LOAD[0]) & (begin <= _AFTER_LOAD[1])).any():
                jumps[run] = True
    return jumps


def _list_excursions(value: np.ndarray, seen: np.ndarray, window: int) -> Iterator[np.ndarray]:
    """Abrupt runs off the median of distinct frames."""
    if seen.size < 2 * _NEIGHBOURS + 2:
        return
    moved = np.concatenate([[True], (np.diff(value[seen], axis=0) != 0).any(axis=1)])
    distinct = seen[moved]
    path = value[distinct]
    noise = _measure_noise(path)
    away = _find_away(path, window, noise)
    beyond = np.append(distinct, len(value))
    edges = np.flatnonzero(np.diff(np.concatenate([[0], away, [0]])))
    for start, end in edges.reshape(-1, 2):
        run = seen[(seen >= distinct[start]) & (seen < beyond[end])]
        if run.size <= _LONGEST_EXCURSION and _is_abrupt(path, away, start, end, noise):
            yield run


def _find_away(path: np.ndarray, window: int, noise: float) -> np.ndarray:
    """Whether samples are away from the running median.

    The path is (sample, axis); the result is 0 or 1.

    False samples shift the median along a motion, by at most a quarter of the window.
    """
    size = min(window, 2 * ((len(path) - 1) // 2) + 1)
    baseline = median_filter(path, (size, 1), mode="nearest")
    steps = _measure_length(np.diff(path, axis=0, append=path[-1:]))
    shifted = 0.25 * size * median_filter(steps, size, mode="nearest")
    return (_measure_length(path - baseline) > np.maximum(_ABOVE_NOISE * noise, shifted)).astype(
        int
    )


def _measure_length(vector: np.ndarray) -> np.ndarray:
    return np.sqrt((vector**2).sum(axis=-1))


def _measure_noise(path: np.ndarray) -> float:
    """Noise sd from second differences, at least rounding."""
    if len(path) < 4:
        return 0.0
    steps = np.abs(np.diff(path, axis=0))
    second = np.abs(np.diff(path, 2, axis=0))
    robust = 1.4826 * np.median(second, axis=0) / np.sqrt(6.0)
    return float(max(np.sqrt((robust**2).sum()), steps[steps > 0].min(initial=np.inf)))


def _is_abrupt(path: np.ndarray, away: np.ndarray, start: int, end: int, noise: float) -> bool:
    """Whether other changes never are so abrupt."""
    before = np.flatnonzero(away[:start] == 0)[-_NEIGHBOURS - 1 :]
    after = end + np.flatnonzero(away[end:] == 0)[: _NEIGHBOURS + 1]
    if not (before.size and after.size):
        return False
    ends = [path[start] - path[before[-1]], path[after[0]] - path[end - 1]]
    step = min(_measure_length(vector) for vector in ends)
    bridge = _measure_length(path[after[0]] - path[before[-1]])
    around = [_measure_length(np.diff(path[k], axis=0)) for k in (before, after)]
    motion = np.sort(np.concatenate([*around, [noise, noise]]))[-2]
    return bool(bridge <= _RETURN * step and step > _ABRUPT * motion)
