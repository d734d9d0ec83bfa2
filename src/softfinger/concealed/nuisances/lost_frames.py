"""Bursts of frames that show nothing."""

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

USUAL = 1e-3  # share of the frames that a sound recording loses


def _draw(fault: Fault, frames: int, rng: Random) -> Flags:
    length = int(fault.shape["frames_in_a_row"])
    lost = np.zeros(frames, bool)
    for start in rng.integers(0, frames - length, max(1, round(fault.size * frames / length))):
        lost[start : start + length] = True
    return lost


def _mark(scene: Scene, fault: Fault, rng: Random) -> Mark:
    """Count what lost frames make less probable."""
    lost = _draw(fault, len(scene.time), rng)
    share = lost.mean()
    gain = lost.sum() * np.log(share / USUAL) + (~lost).sum() * np.log1p(-share)
    return Mark(left_out=lost, nats=float(gain))


def _finish(angle: Array, fault: Fault, rng: Random) -> Array:
    return np.where(_draw(fault, len(angle), rng)[:, None], np.nan, angle)


NUISANCE = Nuisance(
    id="lost_frames",
    sentence="bursts of lost frames",
    finding="lost_frames",
    low=0.05,
    high=0.25,
    shape={"frames_in_a_row": Shape(5.0, 60.0)},
    mark=_mark,
    finish=_finish,
)
