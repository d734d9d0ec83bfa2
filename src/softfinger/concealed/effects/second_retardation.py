"""A narrow spectrum of longer retardation times."""

import numpy as np

from softfinger.concealed.effects.effect import Circumstances, Dose, Effect, Shape
from softfinger.concealed.physics import Physics


def _move(physics: Physics, dose: Dose, trial: Circumstances) -> Physics:
    """Two Voigt elements around the retardation time.

    The slower one is half as large.

    Their compliance is a share of the trial's own elastic compliance, or of the typical one.
    """
    stiffness = physics.k_v if dose.shape["own"] else np.full_like(physics.k_v, 0.1)
    total = dose.spread(physics.k_v.size) / stiffness
    return physics._replace(
        compliance=np.vstack([physics.compliance, total * 2.0 / 3.0, total / 3.0]),
        retardation_time=np.concatenate(
            [physics.retardation_time, dose.shape["retardation_time_s"] * np.array([0.85, 1.4])]
        ),
    )


EFFECT = Effect(
    id="second_retardation",
    sentence="relaxation on a second, longer time scale",
    level="within_trial",
    joints="any",
    typical=0.1,
    largest=0.4,
    shape={"retardation_time_s": Shape(2.0, 12.0), "own": Shape(0.0, 1.0, choice=True)},
    move=_move,
    tell=lambda dose, trials: {
        "retardation_time_s": dose.shape["retardation_time_s"],
        **{f"compliance_share_{j + 1}": dose.strength for j in dose.joints},
    },
)
