"""A load cell's gain that creeps between trials."""

import numpy as np

from softfinger.concealed.effects.effect import Circumstances, Dose, Effect
from softfinger.concealed.physics import Physics


def scale_load(physics: Physics, gain: float) -> Physics:
    """Physics of a load times a factor."""
    return physics._replace(load_tension=gain * physics.load_tension)


def _move(physics: Physics, dose: Dose, trial: Circumstances) -> Physics:
    """Gain of the load in one trial.

    It is 1 + s √(m / M) in the trial after m of M. The strength is what it gains in all.
    """
    return scale_load(physics, 1.0 + dose.strength * np.sqrt(trial.number / trial.count))


EFFECT = Effect(
    id="load_gain",
    sentence="a gain of the load cell that drifts from trial to trial",
    level="between_trials",
    joints="chain",
    typical=0.1,
    largest=0.4,
    move=_move,
    tell=lambda dose, trials: {"gain_per_trial": dose.strength / max(len(trials), 1)},
    covariate="trial_number",
    trials=10,
)
