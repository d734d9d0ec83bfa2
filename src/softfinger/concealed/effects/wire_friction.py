"""Friction of a soft wire over bend and guide.

Its direction is a hysteresis of Bouc and Wen.

A polymer's friction grows with a power of its pressure between two thirds and one, so that its
coefficient is the larger, the less the wire is pulled.

Howell (1953), J. Text. Inst. 44, T359.
"""

import numpy as np

from softfinger.concealed.effects.effect import Circumstances, Dose, Effect, Shape
from softfinger.concealed.physics import Physics


def _move(physics: Physics, dose: Dose, trial: Circumstances) -> Physics:
    return physics._replace(
        friction=np.full_like(physics.k_v, dose.strength),
        friction_power=dose.shape["pressure_power"],
        friction_width=dose.shape["width_rad"],
    )


EFFECT = Effect(
    id="wire_friction",
    sentence="loss along the wire: distal joints get less, loading differs from unloading",
    level="within_trial",
    joints="chain",
    typical=0.1,
    largest=0.4,
    shape={"pressure_power": Shape(0.67, 0.95), "width_rad": Shape(0.005, 0.03)},
    move=_move,
    tell=lambda dose, trials: {"friction_coefficient": dose.strength},
)
