"""Frames a little before or after their time."""

import numpy as np

from softfinger.concealed.nuisances.nuisance import (
    Array,
    Circumstances,
    Fault,
    Mark,
    Nuisance,
    Random,
    Scene,
)

MOST = 150  # frames of a trial in which it counts, to the oracle
LEAST = 0.02  # of the noise: what a frame's jitter must move the finger by to count


def _clock(time: Array, fault: Fault, trial: Circumstances, rng: Random) -> Array:
    """Add a normal error [s] to every time."""
    return time + fault.size * rng.normal(size=time.size)


def _mark(scene: Scene, fault: Fault, rng: Random) -> Mark:
    """Describe it by columns: speed times sd.

    There is one column for each frame in which the finger moves fast.
    """
    moved = fault.size * scene.speed
    size = np.abs(moved).max(axis=1)
    fast = np.argsort(size)[::-1][:MOST]
    fast = fast[size[fast] > LEAST * scene.noise.sd]
    columns = np.zeros((*moved.shape, fast.size))
    columns[fast, :, np.arange(fast.size)] = moved[fast]
    return Mark(columns=columns)


NUISANCE = Nuisance(
    id="timing_jitter",
    sentence="frame times that jitter by milliseconds",
    finding="timing_jitter",
    low=0.001,
    high=0.005,
    clock=_clock,
    mark=_mark,
)
