"""Three lags in a row, as 7:2:1."""

import numpy as np

from softfinger.concealed.effects.effect import Circumstances, Dose, Effect
from softfinger.concealed.physics import Physics

STAGES = np.array([0.7, 0.2, 0.1])
LAST = np.array([0.0, 0.0, 1.0])


def _move(physics: Physics, dose: Dose, trial: Circumstances) -> Physics:
    if dose.strength == 0.0:
        return physics
    return physics._replace(lag_times=dose.strength * STAGES, lag_mix=LAST)


EFFECT = Effect(
    id="actuator_lag",
    sentence="the acting tension lags the logged one",
    level="within_trial",
    joints="chain",
    typical=0.05,
    largest=0.3,
    move=_move,
    tell=lambda dose, trials: {"lag_s": dose.strength},
)
