"""A drive whose tension swings around the log."""

import numpy as np

from softfinger.concealed.effects.effect import Circumstances, Dose, Effect, Shape
from softfinger.concealed.physics import Physics


def _move(physics: Physics, dose: Dose, trial: Circumstances) -> Physics:
    return physics._replace(
        ripple=dose.strength,
        ripple_rate=2.0 * np.pi * dose.shape["frequency_hz"],
        ripple_phase=2.0 * np.pi * trial.luck[0],
    )


EFFECT = Effect(
    id="tension_ripple",
    sentence="a periodic swing of the tension that the log does not show",
    level="within_trial",
    joints="chain",
    typical=0.02,
    largest=0.15,
    shape={"frequency_hz": Shape(0.3, 3.0)},
    move=_move,
)
