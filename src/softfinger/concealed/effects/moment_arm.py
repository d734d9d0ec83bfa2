"""The wire's own chord between its guides."""

from softfinger.concealed.effects.effect import Circumstances, Dose, Effect
from softfinger.concealed.physics import Physics


def _move(physics: Physics, dose: Dose, trial: Circumstances) -> Physics:
    return physics._replace(arm_scale=dose.strength)


EFFECT = Effect(
    id="moment_arm",
    sentence="torque that grows as the joint bends, through the wire's geometry",
    level="within_trial",
    joints="chain",
    typical=1.0,
    largest=1.5,
    move=_move,
    tell=lambda dose, trials: {"arm_scale": dose.strength},
)
