"""A picture that stretches as its mount warms."""

import numpy as np

from softfinger.concealed.effects.effect import Array, Circumstances, Dose, Effect
from softfinger.concealed.rig import Rig


def _record(angle: Array, time: Array, dose: Dose, trial: Circumstances, rig: Rig) -> Array:
    """Directions as seen in the stretched picture.

    Lengths along the base grow by s (1 − cos(2π t / duration)) / 2.
    """
    stretch = 1.0 + 0.5 * dose.strength * (1.0 - np.cos(2.0 * np.pi * time / trial.duration))
    heading = np.cumsum(angle, axis=1)
    seen = np.unwrap(np.arctan2(np.sin(heading), stretch[:, None] * np.cos(heading)), axis=1)
    return np.diff(seen, axis=1, prepend=0.0)


EFFECT = Effect(
    id="picture_stretch",
    sentence="a scale of the picture that comes and goes along one direction",
    level="measurement",
    joints="chain",
    typical=0.03,
    largest=0.2,
    record=_record,
)
