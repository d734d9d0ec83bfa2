"""Power-law creep as eight retardation times."""

from math import gamma

import numpy as np

from softfinger.concealed.effects.effect import Circumstances, Dose, Effect, Shape
from softfinger.concealed.physics import Physics

TIMES_S = np.geomspace(1e-3, 1e3, 8)


def _move(physics: Physics, dose: Dose, trial: Circumstances) -> Physics:
    """Compliance ∝ Tᵅ per element.

    So creep goes as tᵅ between the ends of the ladder.

    A continuous spectrum J(t) = ∫ Tᵅ (1 − e^(−t/T)) d ln T is Γ(1 − α)/α · tᵅ; the strength is the
    creep at one second, as a share of the trial's elastic compliance.
    """
    alpha = dose.shape["exponent"]
    spacing = np.log(TIMES_S[1] / TIMES_S[0])
    weight = spacing * alpha / gamma(1.0 - alpha) * TIMES_S**alpha
    at_one_second = dose.spread(physics.k_v.size) / physics.k_v
    return physics._replace(
        compliance=np.vstack([physics.compliance, weight[:, None] * at_one_second]),
        retardation_time=np.concatenate([physics.retardation_time, TIMES_S]),
    )


EFFECT = Effect(
    id="fractional_creep",
    sentence="creep as a power of time",
    level="within_trial",
    joints="any",
    typical=0.15,
    largest=0.6,
    shape={"exponent": Shape(0.25, 0.55)},
    move=_move,
    tell=lambda dose, trials: {
        "exponent": dose.shape["exponent"],
        **{f"springpot_share_{j + 1}": dose.strength for j in dose.joints},
    },
)
