"""A load cell whose gain drifts.

No measurement model of the diagnosis has a gain that runs with the time of a trial.
"""

import numpy as np

from softfinger.concealed.nuisances.nuisance import (
    Array,
    Circumstances,
    Fault,
    Mark,
    Nuisance,
    Random,
    Scene,
)
from softfinger.concealed.protocols import read_rows, refine_rows


def _log(rows: Array, fault: Fault, trial: Circumstances, rng: Random) -> Array:
    """Scale the tension by 1 + s z t/T.

    z is the trial's own normal number and T its duration.
    """
    rows = refine_rows(rows, 2.0, trial.duration)
    drift = fault.size * rng.normal() * rows[:, 0] / trial.duration
    return np.column_stack([rows[:, 0], rows[:, 1] * (1.0 + drift)])


def _mark(scene: Scene, fault: Fault, rng: Random) -> Mark:
    rows = refine_rows(scene.rows, 2.0, scene.trial.duration)
    error = fault.size * rows[:, 1] * rows[:, 0] / scene.trial.duration
    column = scene.respond(read_rows(np.column_stack([rows[:, 0], error])))
    return Mark(columns=column[..., None])


NUISANCE = Nuisance(
    id="load_cell_drift",
    sentence="a load cell whose gain drifts within a trial",
    finding="",
    also=("noisy_load", "drift"),
    low=0.003,
    high=0.01,
    log=_log,
    mark=_mark,
)
