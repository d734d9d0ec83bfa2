"""Angles that were rounded before they were written."""

import numpy as np

from softfinger.concealed.nuisances.nuisance import Array, Fault, Mark, Nuisance, Random, Scene


def _mark(scene: Scene, fault: Fault, rng: Random) -> Mark:
    """Add independent errors of variance step² / 12."""
    return Mark(rounding=fault.size / scene.noise.sd / np.sqrt(12.0))


def _finish(angle: Array, fault: Fault, rng: Random) -> Array:
    return fault.size * np.round(angle / fault.size)


NUISANCE = Nuisance(
    id="quantised_angles",
    sentence="angles rounded to a step",
    finding="",
    also=("repeated_frames", "heavy_tails"),
    low=0.0005,
    high=0.005,
    mark=_mark,
    finish=_finish,
)
