"""A camera that turns to and fro."""

import numpy as np

from softfinger.concealed.effects.effect import Array, Circumstances, Dose, Effect, Shape
from softfinger.concealed.rig import Rig


def _record(angle: Array, time: Array, dose: Dose, trial: Circumstances, rig: Rig) -> Array:
    phase = 2.0 * np.pi * (time / dose.shape["period_s"] + trial.luck[0])
    swung = angle.copy()
    swung[:, 0] += dose.strength * np.sin(phase)
    return swung


EFFECT = Effect(
    id="camera_swing",
    sentence="a slow rotation of the camera, to and fro, within a trial",
    level="measurement",
    joints="first",
    typical=0.01,
    largest=0.06,
    shape={"period_s": Shape(6.0, 14.0)},
    record=_record,
)
