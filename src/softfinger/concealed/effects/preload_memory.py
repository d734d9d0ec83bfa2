"""Strain from the trial before, less after rest."""

import numpy as np

from softfinger.concealed.effects.effect import Circumstances, Dose, Effect
from softfinger.concealed.physics import Physics

FORGETTING_S = 60.0


def _move(physics: Physics, dose: Dose, trial: Circumstances) -> Physics:
    """Voigt strain at the start of a trial."""
    elastic = physics.load_tension.max() * physics.wire_offset / physics.k_v
    left = dose.spread(physics.k_v.size) * np.exp(-trial.rest / FORGETTING_S)
    return physics._replace(residual=physics.residual + left * elastic)


EFFECT = Effect(
    id="preload_memory",
    sentence="a joint not yet at rest when the trial starts",
    level="within_trial",
    joints="any",
    typical=0.1,
    largest=0.4,
    move=_move,
    tell=lambda dose, trials: {"residual_strain_share": dose.strength},
)
