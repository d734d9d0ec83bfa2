"""A joint that sticks until pulled off."""

import numpy as np

from softfinger.concealed.effects.effect import Array, Circumstances, Dose, Effect
from softfinger.concealed.rig import Rig


def _record(angle: Array, time: Array, dose: Dose, trial: Circumstances, rig: Rig) -> Array:
    """No bend is shown below the strength [rad].

    What it lacked fades within a tenth of a second after it came off.
    """
    stuck = angle.copy()
    for j in dose.joints:
        bent = angle[:, j] - angle[0, j]
        beyond = np.flatnonzero(bent >= dose.strength)
        off = beyond[0] if beyond.size else time.size
        held = np.where(time < time[min(off, time.size - 1)], bent, 0.0)
        if beyond.size:
            late = np.clip(time[off:] - time[off], 0.0, None)
            held[off:] = min(dose.strength, bent[off]) * np.exp(-late / 0.1)
        stuck[:, j] -= held
    return stuck


EFFECT = Effect(
    id="sticky_start",
    sentence="a joint that sticks at the start until it is pulled off",
    level="within_trial",
    joints="any",
    typical=0.05,
    largest=0.2,
    record=_record,
)
