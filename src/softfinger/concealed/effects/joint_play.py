"""Play of a joint, taken up by the wire."""

import numpy as np

from softfinger.concealed.effects.effect import Array, Circumstances, Dose, Effect
from softfinger.concealed.rig import Rig

TAUT_N = 0.3


def _record(angle: Array, time: Array, dose: Dose, trial: Circumstances, rig: Rig) -> Array:
    taut = np.tanh(trial.load.value(time) / TAUT_N)
    return angle + taut[:, None] * dose.spread(angle.shape[1])


EFFECT = Effect(
    id="joint_play",
    sentence="play that is taken up as soon as the wire is taut",
    level="within_trial",
    joints="any",
    typical=0.015,
    largest=0.08,
    record=_record,
    tell=lambda dose, trials: {f"play_rad_{j + 1}": dose.strength for j in dose.joints},
)
