"""A damper that gives way more easily bending."""

from softfinger.concealed.effects.effect import Circumstances, Dose, Effect
from softfinger.concealed.physics import Physics


def _move(physics: Physics, dose: Dose, trial: Circumstances) -> Physics:
    """The Voigt element's rate, larger while it bends.

    The factor is 1 + s. No law of the rate's size distinguishes the two directions.
    """
    return physics._replace(one_way=dose.spread(physics.k_v.size))


EFFECT = Effect(
    id="one_way_damper",
    sentence="a damper that resists a return more than a bend",
    level="within_trial",
    joints="any",
    typical=0.3,
    largest=2.0,
    move=_move,
)
