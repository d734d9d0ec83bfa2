"""A wire that slips in every other trial."""

import numpy as np

from softfinger.concealed.effects.effect import Circumstances, Dose, Effect
from softfinger.concealed.physics import Physics
from softfinger.concealed.protocols import Load


def _move(physics: Physics, dose: Dose, trial: Circumstances) -> Physics:
    """From the slip on, a share is missing."""
    if trial.luck[0] > 0.5 and trial.count > 1:
        return physics
    slips = (0.15 + 0.7 * trial.luck[1]) * trial.duration
    before = physics.load_time < slips
    knots = np.searchsorted(physics.load_time, slips)
    at = Load(physics.load_time, physics.load_tension).value(np.array([slips]))[0]
    left = 1.0 - dose.strength
    time = np.insert(physics.load_time, knots, [slips, slips])
    tension = np.where(before, 1.0, left) * physics.load_tension
    return physics._replace(load_time=time, load_tension=np.insert(tension, knots, [at, left * at]))


EFFECT = Effect(
    id="clamp_slip",
    sentence="a wire that slips in its clamp at a random time of a trial",
    level="within_trial",
    joints="chain",
    typical=0.05,
    largest=0.4,
    move=_move,
)
