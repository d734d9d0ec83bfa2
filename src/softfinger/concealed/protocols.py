"""The four load protocols of concealed campaigns."""

from dataclasses import dataclass
from typing import Literal, get_args

import numpy as np

from softfinger.concealed.arrays import Array

Protocol = Literal["single_step", "levels", "staircase", "triangle"]
PROTOCOLS: tuple[Protocol, ...] = get_args(Protocol)
LOGGED_WITHIN_S = 1e-5  # rows this close show when the load jumped


@dataclass(frozen=True)
class Load:
    """Wire tension over time: knots, repeated for jumps."""

    time: Array  # (knot,) [s], the first at 0, when the trial starts
    tension: Array  # (knot,) [N]

    def value(self, time: Array) -> Array:
        """Tension at some times, after their jumps."""
        at = np.clip(np.searchsorted(self.time, time, side="right") - 1, 0, None)
        following = np.minimum(at + 1, self.time.size - 1)
        span = self.time[following] - self.time[at]
        share = np.where(span > 0, (time - self.time[at]) / np.where(span > 0, span, 1.0), 0.0)
        value = self.tension[at] + share * (self.tension[following] - self.tension[at])
        return np.where(time < self.time[0], 0.0, value)


def _hold(jump_time: Array, level: Array) -> Load:
    """Levels kept from one jump to the next."""
    before = np.concatenate([[0.0], level[:-1]])
    return _begin(np.repeat(jump_time, 2), np.column_stack([before, level]).ravel())


def _begin(time: Array, tension: Array) -> Load:
    """Let a load begin with the trial, at 0."""
    if time[0] > 0.0:
        time, tension = np.append(0.0, time), np.append(0.0, tension)
    return Load(time, tension)


def draw_loads(
    protocol: Protocol, trials: int, rng: np.random.Generator
) -> tuple[list[Load], float]:
    """Draw every trial's load.

    The duration of a trial [s] is returned too.

    ``single_step``: the same step in every trial and held, as in the paper. ``levels``: one of
    four levels held for 25 s, then released. ``staircase``: six levels, some lower than the one
    before, in one of three orders. ``triangle``: two slow rises and falls, the first turned
    before it is back at zero, at one of three speeds.
    """
    peak = rng.uniform(7.0, 9.0)
    rest = float(rng.choice([0.0, 1.0]))
    loads = []
    variants = rng.permutation(np.arange(trials) % (4 if protocol == "levels" else 3))
    for variant in variants:
        if protocol == "single_step":
            loads.append(_hold(np.array([rest]), np.array([peak])))
        elif protocol == "levels":
            level = peak * (0.4, 0.6, 0.8, 1.0)[variant]
            loads.append(_hold(np.array([rest, rest + 25.0]), np.array([level, 0.0])))
        elif protocol == "staircase":
            share = np.array([0.35, 0.75, 0.5, 1.0, 0.6, 0.25])
            share = (share, share[[1, 0, 3, 2, 5, 4]], 0.8 * share[[0, 2, 1, 4, 3, 5]])[variant]
            loads.append(_hold(rest + 6.5 * np.arange(6), peak * share))
        else:
            speed = (1.0, 1.15, 0.9)[variant]
            turn = rest + np.array([0.0, 10.0, 18.0, 26.0, 34.0]) / speed
            loads.append(_begin(turn, peak * np.array([0.0, 1.0, 0.2, 0.9, 0.0])))
    return loads, 40.0


def refine_load(load: Load, every: float) -> Load:
    """Add knots to a load where it changes."""
    time, tension = [load.time[:1]], [load.tension[:1]]
    for k in range(1, load.time.size):
        span, rise = load.time[k] - load.time[k - 1], load.tension[k] - load.tension[k - 1]
        pieces = int(np.ceil(span / every)) if span > 0.0 and rise != 0.0 else 1
        share = np.arange(1, pieces + 1) / pieces
        time.append(load.time[k - 1] + span * share)
        tension.append(load.tension[k - 1] + rise * share)
    return Load(np.concatenate(time), np.concatenate(tension))


def read_rows(rows: Array) -> Load:
    """Read a log (row, 2) back as a load.

    Rows that are close are a jump at the later one.

    >>> read_rows(np.array([[0.0, 0.0], [0.49999, 0.0], [0.5, 6.0]])).time
    array([0. , 0.5, 0.5])
    """
    time = rows[:, 0].copy()
    close = np.diff(time) < 2.0 * LOGGED_WITHIN_S
    time[:-1][close] = time[1:][close]
    return Load(time, rows[:, 1])


def refine_rows(rows: Array, every: float, duration: float) -> Array:
    """Add rows to a log every so many seconds."""
    more = np.arange(every, duration, every)
    more = more[np.abs(more[:, None] - rows[:, 0]).min(axis=1) > 10.0 * LOGGED_WITHIN_S]
    time = np.sort(np.concatenate([rows[:, 0], more]))
    return np.column_stack([time, np.interp(time, rows[:, 0], rows[:, 1])])


def write_rows(load: Load) -> Array:
    """Rows (time, tension); a jump is two."""
    rows = []
    for k, (time, tension) in enumerate(zip(load.time, load.tension, strict=True)):
        if k + 1 < load.time.size and load.time[k + 1] == time:
            if time > 0:
                rows.append([time - LOGGED_WITHIN_S, tension])
        else:
            rows.append([time, tension])
    return np.array(rows)
