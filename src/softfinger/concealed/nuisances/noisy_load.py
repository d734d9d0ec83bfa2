"""A load log whose rows scatter."""

import numpy as np

from softfinger.concealed.nuisances.nuisance import (
    Array,
    Circumstances,
    Fault,
    Mark,
    Nuisance,
    Random,
    Scene,
    Shape,
)
from softfinger.concealed.protocols import read_rows, refine_rows


def _log(rows: Array, fault: Fault, trial: Circumstances, rng: Random) -> Array:
    """Scale every row's tension by 1 + s z.

    Where the log is dense, it has rows every second; else only where the load changes.
    """
    if fault.shape["dense"]:
        rows = refine_rows(rows, 1.0, trial.duration)
    return np.column_stack(
        [rows[:, 0], rows[:, 1] * (1.0 + fault.size * rng.normal(size=len(rows)))]
    )


def _mark(scene: Scene, fault: Fault, rng: Random) -> Mark:
    """Describe it by each row's motion."""
    rows = scene.rows
    columns = []
    for k in np.flatnonzero(rows[:, 1]):
        error = np.zeros(len(rows))
        error[k] = fault.size * rows[k, 1]
        load = read_rows(np.column_stack([rows[:, 0], error]))
        columns.append(scene.respond(load))
    return Mark(columns=np.stack(columns, axis=-1))


NUISANCE = Nuisance(
    id="noisy_load",
    sentence="a load log whose rows scatter",
    finding="noisy_load",
    low=0.003,
    high=0.01,
    shape={"dense": Shape(0.0, 1.0, choice=True)},
    log=_log,
    mark=_mark,
)
