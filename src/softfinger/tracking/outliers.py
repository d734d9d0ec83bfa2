"""Frames that repeat the one before, and samples that are not part of the motion."""

from __future__ import annotations

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view

_LONGEST_EXCURSION = 15  # frames
_NEIGHBOURS = 3  # steps between distinct frames on either side
_ABRUPT = 8.0  # how much larger than any step nearby the steps away and back are
_ABOVE_NOISE = 8.0
_RETURN = 0.25  # how near to its start, in units of the smaller step
_NEARBY_CHANGES = 31
_ALIKE = 1e-4  # difference of two changes that are the same, in the typical change
_MOST_ALIKE = 0.3  # share of changes that have a twin nearby, above which values are rounded


def find_stale_array(angle: np.ndarray) -> np.ndarray:
    """Find frames that repeat the one before: a camera slower than its log.

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
    change = np.abs(np.diff(angle, axis=1))
    gone = np.isnan(angle[:, 1:]) & np.isnan(angle[:, :-1])
    equal = ((change == 0) | gone).all(axis=0) & (change == 0).any(axis=0)
    fine = np.zeros_like(equal)
    for channel in change:
        fine |= _resolves_finely(channel)
    return np.concatenate([[False], equal & fine])


def _resolves_finely(change: np.ndarray) -> np.ndarray:
    """Whether hardly any changes around each one are alike, as unrounded ones are (change,) bool."""
    at = np.flatnonzero(np.isfinite(change) & (change > 0))
    if at.size < 2:
        return np.full(change.size, at.size > 0)
    size = min(_NEARBY_CHANGES, at.size)
    nearby = np.sort(sliding_window_view(change[at], size), axis=1)
    alike = np.diff(nearby, axis=1) < _ALIKE * np.median(nearby, axis=1)[:, None]
    first = (np.searchsorted(at, np.arange(change.size)) - size // 2).clip(0, len(nearby) - 1)
    return alike.mean(axis=1)[first] < _MOST_ALIKE


def find_jumps_array(time: np.ndarray, value: np.ndarray, load_jumps: np.ndarray) -> np.ndarray:
    """Find excursions of a tracker: samples that leave the motion at once, and return at once.

    A run of at most 15 frames is an excursion where the steps into and out of it (i) have opposite
    signs and lead back to where it began, (ii) exceed eight times each of the three steps between
    distinct frames before and after it, (iii) exceed eight noise standard deviations, and (iv) it
    does not begin at a jump of the load. A ring after a step, however fast, fails (ii): its
    neighbours move as well. A step of the finger fails (i): it does not return.

    Parameters
    ----------
    time : (frame,) [s]
    value : (frame,)
        One channel; NaN = missing.
    load_jumps : (jump,) [s]

    Returns
    -------
    (frame,) bool
    """
    jumps = np.zeros(value.size, bool)
    good = np.flatnonzero(np.isfinite(value))
    if good.size < 2 * _NEIGHBOURS:
        return jumps
    distinct = good[np.concatenate([[True], np.diff(value[good]) != 0])]
    x, t = value[distinct], time[distinct]
    step = np.diff(x)
    noise = 1.4826 * np.median(np.abs(np.diff(x, 2))) / np.sqrt(6.0) if x.size > 4 else 0.0
    interval = np.median(np.diff(time[np.isfinite(time)]))
    protected = _near_load_jump(t, load_jumps, interval)
    start = 1
    while start < x.size:
        end = _find_return(x, step, start, noise, protected)
        if end == start:
            start += 1
            continue
        run = (good >= distinct[start]) & (good < (distinct[end] if end < x.size else value.size))
        # An excursion is at most so long in frames of the recording, repeated ones included.
        if run.sum() <= _LONGEST_EXCURSION:
            jumps[good[run]] = True
            x[start:end] = x[start - 1]
            step = np.diff(x)
        start = end
    return jumps


def _near_load_jump(time: np.ndarray, load_jumps: np.ndarray, interval: float) -> np.ndarray:
    """Whether the step into each sample may be the load's doing."""
    near = np.zeros(time.size, bool)
    for jump in load_jumps:
        near |= (time >= jump - 1.5 * interval) & (time <= jump + 3.5 * interval)
    return near


def _find_return(
    x: np.ndarray, step: np.ndarray, start: int, noise: float, protected: np.ndarray
) -> int:
    """First sample after the excursion that begins at `start`; `start` itself if none does."""
    away = step[start - 1]
    if protected[start] or abs(away) <= _ABOVE_NOISE * noise:
        return start
    before = np.abs(step[max(0, start - 1 - _NEIGHBOURS) : start - 1])
    if before.size and abs(away) < _ABRUPT * before.max():
        return start
    for end in range(start + 1, min(x.size, start + 1 + _LONGEST_EXCURSION)):
        back = step[end - 1]
        smaller = min(abs(away), abs(back))
        if back * away >= 0 or abs(x[end] - x[start - 1]) > _RETURN * smaller:
            continue
        after = np.abs(step[end : end + _NEIGHBOURS])
        around = max(before.max(initial=0.0), after.max(initial=0.0), noise)
        return end if smaller > _ABRUPT * around else start
    return start
