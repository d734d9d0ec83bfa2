"""A mount that hums at one frequency."""

import numpy as np

from softfinger.concealed.nuisances.nuisance import Fault, Mark, Nuisance, Random, Scene, Shape


def _mark(scene: Scene, fault: Fault, rng: Random) -> Mark:
    """Swing the base at a phase per trial."""
    size = fault.size * scene.noise.sd
    phase = 2.0 * np.pi * fault.shape["frequency_hz"] * scene.time
    columns = np.zeros((*scene.motion.shape, 2))
    columns[:, 0] = size / np.sqrt(2.0) * np.column_stack([np.sin(phase), np.cos(phase)])
    offset = np.zeros(scene.motion.shape)
    offset[:, 0] = size * np.sin(phase + rng.uniform(0.0, 2.0 * np.pi))
    return Mark(offset=offset, columns=columns)


NUISANCE = Nuisance(
    id="hum",
    sentence="a hum of one frequency",
    finding="",
    also=("drift",),
    low=0.1,
    high=0.6,
    shape={"frequency_hz": Shape(1.5, 8.0)},
    mark=_mark,
)
