"""A camera that stalls and repeats frames."""

import numpy as np

from softfinger.concealed.nuisances.nuisance import (
    Array,
    Fault,
    Flags,
    Mark,
    Nuisance,
    Random,
    Scene,
    Shape,
)

WRITTEN_RAD = 1e-6  # last digit of the files
USUAL = 1e-3  # share of the frames that a sound camera repeats


def _draw(fault: Fault, frames: int, rng: Random) -> Flags:
    """Draw runs of repeats of a mean length."""
    length = max(1, round(fault.shape["frames_in_a_row"]))
    begins = rng.uniform(size=frames) < fault.size / length
    held = np.convolve(begins, np.ones(length))[:frames] > 0
    held[0] = False
    return held


def _mark(scene: Scene, fault: Fault, rng: Random) -> Mark:
    """Leave out frames equal to the last digit.

    Their density is one over that digit.
    """
    held = _draw(fault, len(scene.time), rng)
    share = max(held.mean(), USUAL)
    chance = np.where(held, np.log(share), np.log1p(-share)).sum()
    density = -np.log(WRITTEN_RAD) * held.sum() * scene.motion.shape[1]
    return Mark(left_out=held, nats=float(chance + density))


def _finish(angle: Array, fault: Fault, rng: Random) -> Array:
    held = _draw(fault, len(angle), rng)
    shown = np.maximum.accumulate(np.where(held, 0, np.arange(len(angle))))
    return angle[shown]


NUISANCE = Nuisance(
    id="held_frames",
    sentence="frames that repeat the one before",
    finding="repeated_frames",
    low=0.05,
    high=0.3,
    shape={"frames_in_a_row": Shape(1.0, 8.0)},
    mark=_mark,
    finish=_finish,
)
