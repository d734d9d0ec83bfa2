"""Random streams, per trial and purpose."""

from enum import IntEnum

import numpy as np


class Purpose(IntEnum):
    """What a stream is for; never renumber."""

    PARAMETERS = 0
    CAMERA = 1
    ANGLE_NOISE = 2
    ROOM = 3
    EFFECTS = 4


def build_generator(seed: int, trial_index: int, purpose: Purpose) -> np.random.Generator:
    """Build the generator of one trial and one purpose.

    It depends on nothing else, so the first 12 of 100 trials are the 12 trials of a quick run.

    Examples
    --------
    >>> first, again = (build_generator(7, 0, Purpose.ROOM).random() for _ in range(2))
    >>> first == again
    True
    """
    return np.random.default_rng(np.random.SeedSequence(seed, spawn_key=(purpose, trial_index)))
