"""A batch of trials from another day.

The camera was elsewhere and saw worse, or better.

What it saw is shifted by a constant angle, which no measurement model of the diagnosis has; a shift
of the finger's own parameters would be the effect `session_jump`.
"""

import numpy as np

from softfinger.concealed.nuisances.nuisance import Fault, Mark, Nuisance, Random, Scene, Shape


def _mark(scene: Scene, fault: Fault, rng: Random) -> Mark:
    """Scale the batch's noise, shift the first angle."""
    trial, shape = scene.trial, fault.shape
    first = round(shape["begins"] * trial.count)
    if not first <= trial.number < first + max(1, round(shape["share"] * trial.count)):
        return Mark()
    offset = np.zeros(scene.motion.shape)
    offset[:, 0] = shape["shift_rad"]
    scale = fault.size if shape["worse"] else 1.0 / fault.size
    return Mark(offset=offset, columns=offset[..., None], scale=scale)


NUISANCE = Nuisance(
    id="other_day",
    sentence="a batch of trials from another day",
    finding="uneven_noise",
    also=("drift",),
    low=1.5,
    high=3.0,
    shape={
        "begins": Shape(0.2, 0.6),
        "share": Shape(0.15, 0.35),
        "worse": Shape(0.0, 1.0, choice=True),
        "shift_rad": Shape(0.001, 0.005),
    },
    trials=5,
    mark=_mark,
)
