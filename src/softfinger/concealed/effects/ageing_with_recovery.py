"""Softening from trial to trial; a pause undoes some."""

import numpy as np

from softfinger.concealed.effects.effect import Circumstances, Dose, Effect, Shape
from softfinger.concealed.physics import Physics

SESSIONS = 3


def _move(physics: Physics, dose: Dose, trial: Circumstances) -> Physics:
    """Stiffness and viscosities times 1 − s d.

    d grows within a session, and a pause halves it.
    """
    length = trial.count / SESSIONS
    session, done = divmod(trial.number, length)
    kept = sum(dose.shape["kept"] ** k for k in range(1, int(session) + 1))
    damage = kept + 1.0 - np.exp(-2.0 * done / length)
    left = np.clip(1.0 - dose.spread(physics.k_v.size) * damage, 0.1, None)
    return physics._replace(k_v=physics.k_v * left, c_v=physics.c_v * left, c_p=physics.c_p * left)


EFFECT = Effect(
    id="ageing_with_recovery",
    sentence="softening within each of three sessions, of which a pause undoes a part",
    level="between_trials",
    joints="any",
    typical=0.15,
    largest=0.4,
    shape={"kept": Shape(0.15, 0.5)},
    move=_move,
    covariate="trial_number",
    trials=10,
)
