"""Viscosities or stiffness by Williams, Landel and Ferry."""

import numpy as np

from softfinger.concealed.effects.effect import Circumstances, Dose, Effect, Shape
from softfinger.concealed.physics import Physics

BEND_K = 40.0


def _move(physics: Physics, dose: Dose, trial: Circumstances) -> Physics:
    """Apply the shift factor of the temperature.

    The factor exp(−s ΔT / (1 + ΔT / 40 K)) acts on the viscosities, or on the stiffness.

    The sensitivity s counts as positive where they fall with warmth.
    """
    shift = trial.warmth / (1.0 + trial.warmth / BEND_K)
    factor = np.exp(-dose.spread(physics.k_v.size) * shift)
    if dose.shape["stiffness"]:
        return physics._replace(k_v=physics.k_v * factor)
    return physics._replace(c_v=physics.c_v * factor, c_p=physics.c_p * factor)


EFFECT = Effect(
    id="temperature",
    sentence="viscosities or stiffness that follow the temperature",
    level="between_trials",
    joints="any",
    typical=0.04,
    largest=0.2,
    shape={"stiffness": Shape(0.0, 1.0, choice=True)},
    move=_move,
    tell=lambda dose, trials: {"sensitivity_per_c": dose.strength},
    covariate="temperature_c",
    trials=10,
)
