"""Creep rate with an additional 1.5 power."""

from softfinger.concealed.effects.effect import Circumstances, Dose, Effect
from softfinger.concealed.physics import Physics


def _move(physics: Physics, dose: Dose, trial: Circumstances) -> Physics:
    """Rate τ/c_p (1 + (s τ)^1.5).

    s [1/(N m)] is the inverse of the scale torque.
    """
    return physics._replace(flow_scale=dose.spread(physics.k_v.size))


EFFECT = Effect(
    id="stress_nonlinear_flow",
    sentence="creep rate more than proportional to torque",
    level="within_trial",
    joints="any",
    typical=20.0,
    largest=80.0,
    move=_move,
    tell=lambda dose, trials: {"scale_torque_nm": 1.0 / max(dose.strength, 1e-9)},
)
