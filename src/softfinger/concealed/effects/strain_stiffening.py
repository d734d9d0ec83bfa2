"""A spring by Gent's law, with finite strain."""

from softfinger.concealed.effects.effect import Circumstances, Dose, Effect
from softfinger.concealed.physics import Physics


def _move(physics: Physics, dose: Dose, trial: Circumstances) -> Physics:
    """Stiffness k_v / (1 − β q²).

    β is the inverse square of the locking strain.
    """
    return physics._replace(stiffening=physics.stiffening + dose.spread(physics.k_v.size))


EFFECT = Effect(
    id="strain_stiffening",
    sentence="stiffness that grows with deflection",
    level="within_trial",
    joints="any",
    typical=0.5,
    largest=2.0,
    move=_move,
    tell=lambda dose, trials: {f"stiffening_per_rad2_{j + 1}": dose.strength for j in dose.joints},
)
