"""A damper that resists less when fast."""

from softfinger.concealed.effects.effect import Circumstances, Dose, Effect
from softfinger.concealed.physics import Physics


def _move(physics: Physics, dose: Dose, trial: Circumstances) -> Physics:
    """Rate r (1 + s |r|).

    r is the rate of the linear element, and s is in s/rad.
    """
    return physics._replace(thinning=dose.spread(physics.k_v.size))


EFFECT = Effect(
    id="thinning_damper",
    sentence="stiffness against fast motion that falls with the rate",
    level="within_trial",
    joints="any",
    typical=0.3,
    largest=3.0,
    move=_move,
)
