"""A load log that is read at a rate of its own.

Rows come as a rig writes them: many on each ramp, and steps between two of them.
"""

import numpy as np

from softfinger.concealed.nuisances.nuisance import (
    Array,
    Circumstances,
    Fault,
    Nuisance,
    Random,
)
from softfinger.concealed.protocols import read_rows


def _write(rows: Array, fault: Fault, trial: Circumstances, rng: Random) -> Array:
    """Read the tension every s seconds.

    The first moment is each trial's own.
    """
    first = fault.size * rng.uniform(0.1, 1.0)
    time = np.append(0.0, np.arange(first, trial.duration, fault.size))
    return np.column_stack([time, read_rows(rows).value(time)])


NUISANCE = Nuisance(
    id="sampled_log",
    sentence="a load log that is read at a rate of its own",
    finding="",
    also=("clock_offset", "clock_rate", "timing_jitter"),
    low=0.004,
    high=0.05,
    write=_write,
)
