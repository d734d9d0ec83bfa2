"""A second session with other stiffness."""

import numpy as np

from softfinger.concealed.effects.effect import Circumstances, Dose, Effect, Shape
from softfinger.concealed.physics import Physics


def _move(physics: Physics, dose: Dose, trial: Circumstances) -> Physics:
    if trial.number < dose.shape["first_share"] * trial.count:
        return physics
    sign = 1.0 if dose.shape["stiffer"] else -1.0
    return physics._replace(k_v=physics.k_v * (1.0 + sign * dose.spread(physics.k_v.size)))


EFFECT = Effect(
    id="session_jump",
    sentence="a sudden change of the stiffness between two trials",
    level="between_trials",
    joints="any",
    typical=0.15,
    largest=0.5,
    shape={"first_share": Shape(0.3, 0.7), "stiffer": Shape(0.0, 1.0, choice=True)},
    move=_move,
    covariate="trial_number",
    trials=10,
    tell=lambda dose, trials: {
        "at_trial": float(np.ceil(dose.shape["first_share"] * len(trials))) + 1
    },
)
