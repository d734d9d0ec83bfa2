"""Discs fitted around their predicted places in one picture."""

import math

import numpy as np

from softfinger.compiled import compiled
from softfinger.tracking.body import adapt_distances_array, mark_stretched_array
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
from softfinger.tracking.flat import SUMS
from softfinger.tracking.moments import move_to_moments

_ITERATIONS = np.int64(25)  # far more than a good prediction needs; a plain int compiles anew
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
    rows, flat = np.empty((9, LARGEST_WINDOW)), np.empty((2, len(SUMS)))
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
        found = False
        for start in range(2):  # where its moments are, or else where it is predicted
            p = fitted[k]
            p[:] = known[k]
            p[X], p[Y] = predicted[k]
            if start == 0 and not move_to_moments(picture, weight, p, margin[k], others, k):
                continue
            found = fit_disc_array(
                picture, weight, p, margin[k], others, k, quality[k], rows, flat, _ITERATIONS
            ) and _is_the_disc(p, quality[k], known[k], predicted[k], picture.shape)
            if found:
                break
        if found:
            others[k, 0], others[k, 1] = p[X], p[Y]
        else:
            p[:] = np.nan
            quality[k, :] = np.nan
            others[k, 2] = 0.0


@compiled
def _is_the_disc(
    p: np.ndarray,
    quality: np.ndarray,
    known: np.ndarray,
    predicted: np.ndarray,
    shape: tuple[int, int, int],
) -> bool:
    """Whether a fit is of the known disc, near its place."""
    inside = -0.5 <= p[X] <= shape[1] - 0.5 and -0.5 <= p[Y] <= shape[0] - 0.5
    near = math.hypot(p[X] - predicted[0], p[Y] - predicted[1]) < 2.0 * p[RADIUS]
    return inside and near and looks_alike_array(p, known) and is_certain_array(p, quality)


@compiled
def follow_markers_array(
    picture: np.ndarray,
    weight: np.ndarray,
    known: np.ndarray,
    margin: np.ndarray,
    velocity: np.ndarray,
    lost_for: np.ndarray,
    first: np.ndarray,
    second: np.ndarray,
    distance: np.ndarray,
    predicted: np.ndarray,
    fitted: np.ndarray,
    quality: np.ndarray,
) -> bool:
    """Fit every marker that was seen last; settle if none is lost.

    Parameters
    ----------
    picture, weight, known, margin
        As for `follow_discs_array`.
    velocity, lost_for : (marker, 2) [px], (marker,)
        Overwritten, as `known` is, if every marker is seen.
    first, second, distance
        (pair,): markers that are rigid together, and their distance [px], which adapts.
    predicted, fitted, quality : (marker, 2), (marker, 8), (marker, 5)
        Overwritten.

    Returns
    -------
    bool
        Whether every marker is seen.
    """
    predicted[:] = known[:, :2] + velocity
    fitted[:] = np.nan
    quality[:] = np.nan
    follow_discs_array(picture, weight, known, margin, lost_for == 0, predicted, fitted, quality)
    drop_stretched_array(first, second, distance, known, fitted, quality)
    for k in range(known.shape[0]):
        if math.isnan(fitted[k, X]):
            return False
    settle_markers_array(known, velocity, lost_for, first, second, distance, fitted)
    return True


@compiled
def drop_stretched_array(
    first: np.ndarray,
    second: np.ndarray,
    distance: np.ndarray,
    known: np.ndarray,
    fitted: np.ndarray,
    quality: np.ndarray,
) -> None:
    """Forget fits at a wrong distance from their link's others."""
    wrong = mark_stretched_array(fitted[:, :2], known[:, RADIUS], first, second, distance)
    for k in range(known.shape[0]):
        if wrong[k]:
            fitted[k, :] = np.nan
            quality[k, :] = np.nan


@compiled
def settle_markers_array(
    known: np.ndarray,
    velocity: np.ndarray,
    lost_for: np.ndarray,
    first: np.ndarray,
    second: np.ndarray,
    distance: np.ndarray,
    fitted: np.ndarray,
) -> None:
    """Take what was fitted for known; all but `fitted` is overwritten."""
    for k in range(known.shape[0]):
        seen = not math.isnan(fitted[k, X])
        for axis in range(2):
            fresh = seen and lost_for[k] == 0
            velocity[k, axis] = fitted[k, axis] - known[k, axis] if fresh else 0.0
        if seen:
            known[k] = fitted[k]
        lost_for[k] = 0 if seen else lost_for[k] + 1
    adapt_distances_array(fitted[:, :2], first, second, distance)


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
