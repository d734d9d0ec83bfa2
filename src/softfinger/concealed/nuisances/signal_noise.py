"""Noise that grows as the finger bends."""

import numpy as np

from softfinger.concealed.nuisances.nuisance import Fault, Mark, Nuisance, Random, Scene


def _mark(scene: Scene, fault: Fault, rng: Random) -> Mark:
    """Scale the noise by √(1 + (s d)²).

    d is the deflection from the first frame, and s is in 1/rad.
    """
    deflection = scene.motion - scene.motion[0]
    return Mark(scale=np.sqrt(1.0 + (fault.size * deflection) ** 2))


NUISANCE = Nuisance(
    id="signal_noise",
    sentence="noise that grows with the deflection",
    finding="signal_noise",
    low=2.0,
    high=8.0,
    mark=_mark,
)
