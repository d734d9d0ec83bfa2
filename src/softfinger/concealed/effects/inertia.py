"""Mass of the links, and of what they carry."""

from softfinger.concealed.effects.effect import Circumstances, Dose, Effect
from softfinger.concealed.physics import Physics


def _move(physics: Physics, dose: Dose, trial: Circumstances) -> Physics:
    return physics._replace(inertia_scale=dose.strength)


EFFECT = Effect(
    id="inertia",
    sentence="mass that the step solution ignores",
    level="within_trial",
    joints="chain",
    typical=4.0,
    largest=30.0,
    move=_move,
    tell=lambda dose, trials: {"inertia_scale": dose.strength},
)
