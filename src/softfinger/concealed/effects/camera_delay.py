"""A recording that starts late.

The delay differs a little in every trial.
"""

import numpy as np

from softfinger.concealed.effects.effect import Array, Circumstances, Dose, Effect


def _delay(dose: Dose, trial: Circumstances) -> float:
    """Delay [s] of a trial, within 10 %."""
    return dose.strength * (0.9 + 0.2 * trial.luck[0])


def _clock(time: Array, dose: Dose, trial: Circumstances) -> Array:
    """Time that a frame shows: its own less delay."""
    return time - _delay(dose, trial)


def _tell(dose: Dose, trials: list[Circumstances]) -> dict[str, float]:
    return {"delay_s": float(np.mean([_delay(dose, trial) for trial in trials]))}


EFFECT = Effect(
    id="camera_delay",
    sentence="the recording is shifted in time against the load log",
    level="measurement",
    joints="chain",
    typical=0.03,
    largest=0.2,
    clock=_clock,
    tell=_tell,
)
