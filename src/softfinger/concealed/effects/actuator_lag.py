"""Three lags in a row, seven to two to one, not one or two."""

from __future__ import annotations

from softfinger.concealed.effects.effect import Circumstances, Dose, Effect
from softfinger.concealed.physics import Physics


def _move(physics: Physics, dose: Dose, trial: Circumstances) -> Physics:
    return physics._replace(lag=dose.strength)


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
