"""Capstan friction over bend and guide, its direction a hysteresis of Bouc and Wen."""

from __future__ import annotations

import numpy as np

from softfinger.concealed.effects.effect import Circumstances, Dose, Effect, Shape
from softfinger.concealed.physics import Physics


def _move(physics: Physics, dose: Dose, trial: Circumstances) -> Physics:
    return physics._replace(
        friction=np.full_like(physics.k_v, dose.strength),
        friction_width=dose.shape["width_rad"],
    )


EFFECT = Effect(
    id="wire_friction",
    sentence="loss along the wire: distal joints get less, loading differs from unloading",
    level="within_trial",
    joints="chain",
    typical=0.1,
    largest=0.4,
    shape={"width_rad": Shape(0.005, 0.03)},
    move=_move,
    tell=lambda dose, trials: {"friction_coefficient": dose.strength},
)
