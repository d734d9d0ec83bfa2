"""Discs followed from picture to picture by their motion and appearance."""

from __future__ import annotations

import math

import numpy as np
from numba import njit

from softfinger.tracking.disc import CONTRAST, RADIUS, SPREAD, X, Y
from softfinger.tracking.fit import CONVERGED, fit_disc_array

_ITERATIONS = 8
_TOLERANCE = 0.02  # px: what a Gauss–Newton step of this size leaves is far below the noise


@njit(cache=True)
def looks_alike_array(found, known):
    """Whether a fitted disc is the known one: contrast of the same sign and size, same radius."""
    contrast = found[CONTRAST] / known[CONTRAST]
    radius = found[RADIUS] / known[RADIUS]
    return 0.4 < contrast < 2.5 and 0.6 < radius < 1.6


@njit(cache=True)
def follow_discs_array(frame, weight, known, seen, predicted, fitted, quality):
    """Fit every disc near its predicted place.

    Parameters
    ----------
    frame : (row, column, channel)
    weight : (channel,)
    known : (disc, 8)
        How each disc looked when it was last seen.
    seen : (disc,) bool
        Whether to look for it. Overwritten: whether it was found.
    predicted : (disc, 2) [px]
        Where to look.
    fitted, quality : (disc, 8), (disc, 6)
        Filled.
    """
    others = np.empty((known.shape[0], 3))
    for k in range(known.shape[0]):
        others[k, 0], others[k, 1] = predicted[k]
        others[k, 2] = known[k, RADIUS] + 2.0 * known[k, SPREAD] if seen[k] else 0.0
    for k in range(known.shape[0]):
        if not seen[k]:
            continue
        p = fitted[k]
        p[:] = known[k]
        p[X], p[Y] = predicted[k]
        seen[k] = False
        if fit_disc_array(frame, weight, p, others, k, quality[k], _ITERATIONS, _TOLERANCE):
            inside = -0.5 <= p[X] <= frame.shape[1] - 0.5 and -0.5 <= p[Y] <= frame.shape[0] - 0.5
            near = math.hypot(p[X] - predicted[k, 0], p[Y] - predicted[k, 1]) < 2.0 * p[RADIUS]
            if inside and near and quality[k, CONVERGED] > 0.0:
                seen[k] = looks_alike_array(p, known[k])
        if seen[k]:
            others[k, 0], others[k, 1] = p[X], p[Y]
