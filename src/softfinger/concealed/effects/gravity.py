"""Weight of the links in a tilted plane."""

import numpy as np

from softfinger.concealed.effects.effect import Circumstances, Dose, Effect, Shape
from softfinger.concealed.physics import Physics

STANDARD_GRAVITY = 9.80665


def _move(physics: Physics, dose: Dose, trial: Circumstances) -> Physics:
    """Tilt along the base, or across it."""
    along = STANDARD_GRAVITY * np.sin(dose.strength)
    if dose.shape["along_base"]:
        return physics._replace(gravity_x=physics.gravity_x + along)
    return physics._replace(gravity_y=physics.gravity_y - along)


EFFECT = Effect(
    id="gravity",
    sentence="torque of the links' weight, which depends on the configuration",
    level="within_trial",
    joints="chain",
    typical=0.15,
    largest=0.6,
    shape={"along_base": Shape(0.0, 1.0, choice=True)},
    move=_move,
    tell=lambda dose, trials: {"tilt_rad": dose.strength},
)
