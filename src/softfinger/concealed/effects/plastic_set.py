"""A joint that keeps a set once overbent."""

from softfinger.concealed.effects.effect import Circumstances, Dose, Effect, Shape
from softfinger.concealed.physics import Physics


def _move(physics: Physics, dose: Dose, trial: Circumstances) -> Physics:
    """Shift the rest by strain beyond a threshold."""
    return physics._replace(
        plastic=dose.spread(physics.k_v.size), plastic_from=dose.shape["from_rad"]
    )


EFFECT = Effect(
    id="plastic_set",
    sentence="a set that stays where a joint was strained beyond a threshold",
    level="within_trial",
    joints="any",
    typical=0.15,
    largest=0.6,
    shape={"from_rad": Shape(0.1, 0.25)},
    move=_move,
)
