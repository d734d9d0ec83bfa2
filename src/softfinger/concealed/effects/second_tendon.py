"""A second wire along the back, at first slack."""

from softfinger.concealed.effects.effect import Circumstances, Dose, Effect, Shape
from softfinger.concealed.physics import Physics


def _move(physics: Physics, dose: Dose, trial: Circumstances) -> Physics:
    """Torque s (Σq − slack) on every joint."""
    return physics._replace(tendon=dose.strength, tendon_slack=dose.shape["slack_rad"])


EFFECT = Effect(
    id="second_tendon",
    sentence="a second wire that is taut beyond a bend of the whole finger",
    level="within_trial",
    joints="chain",
    typical=0.004,
    largest=0.04,
    shape={"slack_rad": Shape(0.4, 0.8)},
    move=_move,
)
