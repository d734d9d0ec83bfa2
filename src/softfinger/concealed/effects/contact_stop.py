"""A stop with a Hertzian contact."""

from softfinger.concealed.effects.effect import Circumstances, Dose, Effect, Shape
from softfinger.concealed.physics import Physics


def _move(physics: Physics, dose: Dose, trial: Circumstances) -> Physics:
    """Torque −K (q − stop)^1.5, K [N m/rad^1.5]."""
    joints = physics.k_v.size
    return physics._replace(
        stop_stiffness=dose.spread(joints),
        stop_angle=0.0 * physics.k_v + dose.shape["stop_angle_rad"],
    )


EFFECT = Effect(
    id="contact_stop",
    sentence="a joint that meets a stop",
    level="within_trial",
    joints="one",
    typical=1.0,
    largest=20.0,
    shape={"stop_angle_rad": Shape(0.18, 0.35)},
    move=_move,
    tell=lambda dose, trials: {
        f"stop_angle_rad_{j + 1}": dose.shape["stop_angle_rad"] for j in dose.joints
    },
)
