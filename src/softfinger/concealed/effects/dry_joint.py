"""A joint with dry friction on its support."""

from softfinger.concealed.effects.effect import Circumstances, Dose, Effect
from softfinger.concealed.physics import Physics


def _move(physics: Physics, dose: Dose, trial: Circumstances) -> Physics:
    """Dry friction of at most s [N m].

    The torque acts against the joint's motion and is turned round over 5 mrad.
    """
    return physics._replace(dry=dose.spread(physics.k_v.size))


EFFECT = Effect(
    id="dry_joint",
    sentence="dry friction in a joint, against its own motion",
    level="within_trial",
    joints="any",
    typical=0.002,
    largest=0.01,
    move=_move,
)
