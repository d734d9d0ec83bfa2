"""Softening by the largest strain before (Mullins)."""

from softfinger.concealed.effects.effect import Circumstances, Dose, Effect
from softfinger.concealed.physics import Physics


def _move(physics: Physics, dose: Dose, trial: Circumstances) -> Physics:
    return physics._replace(mullins=dose.spread(physics.k_v.size))


EFFECT = Effect(
    id="mullins_softening",
    sentence="stiffness lost within a trial up to the largest strain so far",
    level="within_trial",
    joints="any",
    typical=0.1,
    largest=0.5,
    move=_move,
)
