"""Noise whose innovations have heavy tails."""

import numpy as np

from softfinger.concealed.nuisances.nuisance import Fault, Mark, Nuisance, Random, Scene


def _mark(scene: Scene, fault: Fault, rng: Random) -> Mark:
    """Scale each frame's innovation to Student's t.

    The size is its freedom ν.

    The factor √((ν − 2) / χ²_ν) is one for all joints of a frame and leaves the variance as it is.
    """
    freedom = fault.size
    shock = np.sqrt((freedom - 2.0) / rng.chisquare(freedom, len(scene.time)))
    return Mark(shock=shock, tails=freedom)


NUISANCE = Nuisance(
    id="student_noise",
    sentence="innovations with the tails of Student's t",
    finding="heavy_tails",
    also=("outliers",),
    low=2.5,
    high=5.0,
    mark=_mark,
)
