"""Discs fitted around their predicted places in one picture."""

import math

import numpy as np

from softfinger.compiled import compiled
from softfinger.tracking.disc import CONTRAST, RADIUS, SPREAD, X, Y
from softfinger.tracking.fit import (
    FIT_QUALITY,
    LARGEST_WINDOW,
    MARGINS,
    MISFIT,
    NOISE_VARIANCE,
    UNIT_XX,
    UNIT_YY,
    fit_disc_array,
)

_ITERATIONS = 25  # far more than a good prediction needs
_CONTRAST_CHANGE = (0.4, 2.5)  # from one picture to the next
_RADIUS_CHANGE = (0.6, 1.6)
_LARGEST_SD = 0.15  # radii: less certain than that, a disc is not seen
_LARGEST_RESIDUAL = 0.35  # rms on the rim, in contrasts
_LARGEST_RISE = 1.5  # of the noise variance, where a wider margin contains nothing new
_ROUNDING = 0.5  # of the light, squared: below it a rise means nothing


@compiled
def looks_alike_array(found: np.ndarray, known: np.ndarray) -> bool:
    """Whether a disc has the known contrast, radius."""
    contrast = found[CONTRAST] / known[CONTRAST]
    radius = found[RADIUS] / known[RADIUS]
    return (
        _CONTRAST_CHANGE[0] < contrast < _CONTRAST_CHANGE[1]
        and _RADIUS_CHANGE[0] < radius < _RADIUS_CHANGE[1]
    )


@compiled
def is_certain_array(found: np.ndarray, quality: np.ndarray) -> bool:
    """Whether the rim's misfit is small against contrast."""
    variance = max(quality[UNIT_XX], quality[UNIT_YY]) * quality[NOISE_VARIANCE]
    residual = quality[MISFIT] * quality[NOISE_VARIANCE]
    return (
        variance < (_LARGEST_SD * found[RADIUS]) ** 2
        and residual < (_LARGEST_RESIDUAL * found[CONTRAST]) ** 2
    )


@compiled
def follow_discs_array(
    picture: np.ndarray,
    weight: np.ndarray,
    known: np.ndarray,
    margin: np.ndarray,
    wanted: np.ndarray,
    predicted: np.ndarray,
    fitted: np.ndarray,
    quality: np.ndarray,
) -> None:
    """Fit the wanted discs near their predicted places.

    Parameters
    ----------
    picture : (row, column, channel)
    weight : (channel,)
        Light = Σ weight · channel.
    known : (disc, 8)
        How each disc looked when it was last seen.
    margin : (disc,) [px]
        Width of the background that each disc is fitted with.
    wanted : (disc,) bool
        Which discs to look for.
    predicted : (disc, 2) [px]
        Where to look.
    fitted, quality : (disc, 8), (disc, 5)
        Rows of wanted discs are overwritten, with NaN where the disc is not seen; the others are
        discs that are known to be there.
    """
    rows, side = np.empty((9, LARGEST_WINDOW)), np.empty(LARGEST_WINDOW, np.uint8)
    others = np.empty((known.shape[0], 3))
    for k in range(known.shape[0]):
        seen = not math.isnan(fitted[k, X])
        others[k, 0] = predicted[k, 0] if wanted[k] or not seen else fitted[k, X]
        others[k, 1] = predicted[k, 1] if wanted[k] or not seen else fitted[k, Y]
        reach = known[k, RADIUS] + 2.0 * known[k, SPREAD]
        others[k, 2] = reach if wanted[k] or seen else 0.0
    for k in range(known.shape[0]):
        if not wanted[k]:
            continue
        p = fitted[k]
        p[:] = known[k]
        p[X], p[Y] = predicted[k]
        found = fit_disc_array(
            picture, weight, p, margin[k], others, k, quality[k], rows, side, _ITERATIONS
        )
        inside = -0.5 <= p[X] <= picture.shape[1] - 0.5 and -0.5 <= p[Y] <= picture.shape[0] - 0.5
        near = math.hypot(p[X] - predicted[k, 0], p[Y] - predicted[k, 1]) < 2.0 * p[RADIUS]
        if (
            found
            and inside
            and near
            and looks_alike_array(p, known[k])
            and is_certain_array(p, quality[k])
        ):
            others[k, 0], others[k, 1] = p[X], p[Y]
        else:
            p[:] = np.nan
            quality[k, :] = np.nan
            others[k, 2] = 0.0


def choose_margins_array(picture: np.ndarray, weight: np.ndarray, known: np.ndarray) -> np.ndarray:
    """Widest background around each disc (disc,) [px].

    It contains nothing else.

    Markers are fixed to their links, so what surrounds them is the same in every picture.
    """
    noise = np.full((len(MARGINS), len(known)), np.inf)
    for k, margin in enumerate(MARGINS):
        fitted, quality = np.empty_like(known), np.empty((len(known), len(FIT_QUALITY)))
        margins, wanted = np.full(len(known), margin), np.ones(len(known), bool)
        places = known[:, [X, Y]].copy()
        follow_discs_array(picture, weight, known, margins, wanted, places, fitted, quality)
        seen = np.isfinite(fitted[:, X])
        noise[k, seen] = quality[seen, NOISE_VARIANCE]
    plain = noise <= _LARGEST_RISE * noise[0] + _ROUNDING
    return np.array([max(m for m, ok in zip(MARGINS, row, strict=True) if ok) for row in plain.T])
