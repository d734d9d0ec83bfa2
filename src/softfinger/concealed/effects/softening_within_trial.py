"""Stiffness or viscosity that falls within a trial."""

from softfinger.concealed.effects.effect import Circumstances, Dose, Effect, Shape
from softfinger.concealed.physics import Physics

Warming = tuple[float, float, float, float]


def soften(physics: Physics, dose: Dose, warming: Warming) -> Physics:
    """Let stiffness or viscosities lose a share."""
    share = dose.spread(physics.k_v.size)
    if dose.shape["viscosity"]:
        return physics._replace(thinning_out=share, warming=warming)
    return physics._replace(softening=share, warming=warming)


def _move(physics: Physics, dose: Dose, trial: Circumstances) -> Physics:
    """Soften as a joint warms up.

    The warmth w follows ẇ = (1 − w)^1.5 / T. Towards the end it is slower than an exponential.
    """
    return soften(physics, dose, (1.0 / dose.shape["softening_time_s"], 1.5, 0.0, 0.0))


EFFECT = Effect(
    id="softening_within_trial",
    sentence="stiffness or viscosity that falls while a trial runs",
    level="within_trial",
    joints="any",
    typical=0.15,
    largest=0.6,
    shape={
        "softening_time_s": Shape(3.0, 15.0),
        "viscosity": Shape(0.0, 1.0, choice=True),
    },
    move=_move,
    tell=lambda dose, trials: {
        "softening_time_s": dose.shape["softening_time_s"],
        **{f"softening_share_{j + 1}": dose.strength for j in dose.joints},
    },
)
