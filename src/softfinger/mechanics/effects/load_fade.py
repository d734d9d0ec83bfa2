"""A load that fades while the drive warms.

Less and less of the logged load acts: u (1 − (f + g |u|/reference) t/T), t in the trial.
"""

import math

import numpy as np
from numpy.typing import NDArray

from softfinger.compiled import compiled
from softfinger.mechanics.forward.slot import Slot, declare
from softfinger.mechanics.forward.work import Model

PIECES = 30
"""Straight lines in T, and in the reference: a bent one bows from them by 10⁻³ of what is lost."""
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
    time, load, changes = _refine(time, load, changes, reach, reference)
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
    time: NDArray, load: NDArray, changes: NDArray, reach: float, reference: float
) -> tuple[NDArray, NDArray, NDArray]:
    """The same log in short lines, to `reach` at least."""
    last = time.size - 1
    span, pieces = np.zeros(time.size), np.ones(time.size, np.int64)
    for knot in range(time.size):
        end = time[knot + 1] if knot < last else max(reach, time[last])
        rise = abs(load[min(knot + 1, last)] - load[knot]) / reference
        span[knot] = end - time[knot]
        if span[knot] > 0.0:  # not a jump
            parts = PIECES * max(span[knot] / reach, rise)
            pieces[knot] = max(1, math.ceil(parts - 1e-9))
    most = pieces.sum() + 1
    fine, value, change = np.empty(most), np.empty(most), np.empty((most, changes.shape[1]))
    count = 0
    for knot in range(time.size):
        after = min(knot + 1, last)
        for piece in range(pieces[knot]):
            share = piece / pieces[knot]
            fine[count] = time[knot] + share * span[knot]
            value[count] = load[knot] + share * (load[after] - load[knot])
            change[count] = changes[knot] + share * (changes[after] - changes[knot])
            count += 1
    if span[last] > 0.0:
        fine[count], value[count], change[count] = reach, load[last], changes[last]
        count += 1
    return fine[:count].copy(), value[:count].copy(), change[:count].copy()
