"""A dashpot that yields at a soft corner."""

from softfinger.concealed.effects.effect import Circumstances, Dose, Effect
from softfinger.concealed.physics import Physics


def _move(physics: Physics, dose: Dose, trial: Circumstances) -> Physics:
    return physics._replace(yield_torque=dose.spread(physics.k_v.size))


EFFECT = Effect(
    id="yield_threshold",
    sentence="a dashpot that flows only above a torque",
    level="within_trial",
    joints="any",
    typical=0.01,
    largest=0.03,
    move=_move,
    tell=lambda dose, trials: {"threshold_nm": dose.strength},
)
