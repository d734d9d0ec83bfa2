"""A load that fades while the drive warms.

Less and less of the logged load acts: u (1 − (f + g |u|/reference) t/T), t in the trial.
"""

import math

import numpy as np
from numpy.typing import NDArray

from softfinger.compiled import compiled
from softfinger.mechanics.forward.slot import Slot, declare
from softfinger.mechanics.forward.work import Model

PIECES = 100
"""Straight lines in T: of a bent one they miss less than 10⁻³ of the load."""
FADE, SAG, REFERENCE, TIME = declare(
    load_fade=Slot("chain", "1", 0.0, "share f of the load that is lost at T", below=1.0),
    load_sag=Slot(
        "chain", "1", 0.0, "share g lost beside it where |u| is the reference", below=1.0
    ),
    load_fade_reference=Slot("chain", "N m", 1.0, "that reference", "positive", constant=True),
    load_fade_time=Slot(
        "chain", "s", 1.0, "T, beyond which no more is lost", "positive", constant=True
    ),
)


@compiled
def is_fading(model: Model) -> bool:
    """Whether a load fades, or a direction lets it."""
    moved = model.d_chain[:, FADE].any() or model.d_chain[:, SAG].any()
    return moved or model.chain[FADE] != 0.0 or model.chain[SAG] != 0.0


@compiled
def fade_log(
    model: Model, time: NDArray, load: NDArray, changes: NDArray
) -> tuple[NDArray, NDArray, NDArray]:
    """The log (knot,) that acts, with its changes (knot, column)."""
    reach, reference = model.chain[TIME], model.chain[REFERENCE]
    time, load, changes = _refine(time, load, changes, reach)
    for knot in range(time.size):
        x, u = min(max(time[knot] / reach, 0.0), 1.0), load[knot]
        sag = model.chain[SAG] * abs(u) / reference
        load[knot] = u * (1.0 - (model.chain[FADE] + sag) * x)
        slope = 1.0 - (model.chain[FADE] + 2.0 * sag) * x
        for c in range(changes.shape[1]):
            lost = model.d_chain[c, FADE] + model.d_chain[c, SAG] * abs(u) / reference
            changes[knot, c] = slope * changes[knot, c] - u * x * lost
    return time, load, changes


@compiled
def _refine(
    time: NDArray, load: NDArray, changes: NDArray, reach: float
) -> tuple[NDArray, NDArray, NDArray]:
    """The same log in short lines, to `reach` at least."""
    last, longest = time.size - 1, reach / PIECES
    most = 2 * time.size + int((max(reach, time[last]) - time[0]) / longest) + 2
    fine, value, change = np.empty(most), np.empty(most), np.empty((most, changes.shape[1]))
    count = 0
    for knot in range(time.size):
        after = min(knot + 1, last)
        span = (time[after] if knot < last else max(reach, time[last])) - time[knot]
        pieces = max(1, math.ceil(span / longest - 1e-9))
        for piece in range(pieces):
            share = piece / pieces
            fine[count] = time[knot] + share * span
            value[count] = load[knot] + share * (load[after] - load[knot])
            change[count] = changes[knot] + share * (changes[after] - changes[knot])
            count += 1
    if reach > time[last]:
        fine[count], value[count], change[count] = reach, load[last], changes[last]
        count += 1
    return fine[:count].copy(), value[:count].copy(), change[:count].copy()
