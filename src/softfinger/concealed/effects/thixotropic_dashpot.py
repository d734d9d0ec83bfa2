"""A dashpot whose structure breaks, and heals at rest."""

from softfinger.concealed.effects.effect import Circumstances, Dose, Effect, Shape
from softfinger.concealed.physics import Physics

HEALING_S = 20.0


def _move(physics: Physics, dose: Dose, trial: Circumstances) -> Physics:
    """Rate τ/c_p (1 + s b).

    b is the broken share: ḃ = g |rate| (1 − b) − b/20 s.

    Moore (1959), Trans. Br. Ceram. Soc. 58, 470.
    """
    return physics._replace(
        thixotropy=dose.spread(physics.k_v.size),
        breaking=dose.shape["breaking_per_rad"],
        healing=1.0 / HEALING_S,
    )


EFFECT = Effect(
    id="thixotropic_dashpot",
    sentence="a dashpot that thins as it flows and thickens as it rests",
    level="within_trial",
    joints="any",
    typical=1.0,
    largest=6.0,
    shape={"breaking_per_rad": Shape(20.0, 100.0)},
    move=_move,
)
