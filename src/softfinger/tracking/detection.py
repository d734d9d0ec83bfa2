"""Discs anywhere in a picture: where tracking starts, and where it starts again."""

from __future__ import annotations

import cv2
import numpy as np

from softfinger.tracking.disc import CONTRAST, LEVEL, RADIUS, SPREAD, X, Y
from softfinger.tracking.fit import FIT_QUALITY, MISFIT, NOISE_VARIANCE, fit_disc_array

_RADIUS_RANGE = (0.6, 1.6)
_SMALLEST_CONTRAST = 6.0  # in noise standard deviations
_MOST_CANDIDATES = 200
_NO_DISCS = np.empty((0, 3))


def find_discs_array(
    frame: np.ndarray, weight: np.ndarray, radius: float, polarity: int
) -> np.ndarray:
    """Find every disc of about a given radius in a picture, however uneven its light.

    Places where the picture differs most from its surroundings (a difference of two Gaussian
    means, which no even slope of light can imitate) are fitted by blurred discs.

    Parameters
    ----------
    frame : (row, column, channel)
    weight : (channel,)
        Light = Σ weight · channel.
    radius : float [px]
        Expected radius; discs within 0.6 to 1.6 of it are taken.
    polarity : int
        −1 dark discs, +1 light ones, 0 both.

    Returns
    -------
    numpy.ndarray (disc, 8)
        Parameters of :data:`softfinger.tracking.disc.PARAMETERS`, strongest contrast first.
    """
    light = frame.astype(np.float32) @ weight.astype(np.float32)
    narrow = cv2.GaussianBlur(light, (0, 0), 0.6 * radius)
    difference = narrow - cv2.GaussianBlur(light, (0, 0), 1.5 * radius)
    found: list[np.ndarray] = []
    for row, column in _list_peaks(difference, polarity, radius):
        parameters = _fit_anywhere(frame, weight, column, row, radius, difference[row, column])
        if parameters is not None and not _is_known(parameters, found):
            found.append(parameters)
    found.sort(key=lambda p: -abs(p[CONTRAST]))
    return np.array(found).reshape(-1, 8)


def _list_peaks(difference: np.ndarray, polarity: int, radius: float) -> np.ndarray:
    strength = np.abs(difference) if polarity == 0 else polarity * difference
    size = 2 * max(1, round(0.7 * radius)) + 1
    highest = cv2.dilate(strength, np.ones((size, size), np.uint8))
    typical = 1.4826 * np.median(np.abs(difference))
    rows, columns = np.nonzero((strength == highest) & (strength > max(1.0, 4.0 * typical)))
    order = np.argsort(-strength[rows, columns], kind="stable")[:_MOST_CANDIDATES]
    return np.stack([rows[order], columns[order]], axis=1)


def _fit_anywhere(
    frame: np.ndarray,
    weight: np.ndarray,
    column: int,
    row: int,
    radius: float,
    difference: float,
) -> np.ndarray | None:
    around = frame[
        max(0, int(row - 2 * radius)) : int(row + 2 * radius) + 1,
        max(0, int(column - 2 * radius)) : int(column + 2 * radius) + 1,
    ].astype(float)
    level = float(np.median(around @ weight))
    contrast = 2.2 * float(difference)
    p = np.array([column, row, contrast, radius, 1.0, level, 0.0, 0.0])
    quality = np.empty(len(FIT_QUALITY))
    if not fit_disc_array(frame, weight, p, _NO_DISCS, -1, quality, 30, 0.02):
        return None
    near = np.hypot(p[X] - column, p[Y] - row) < radius
    sized = _RADIUS_RANGE[0] < p[RADIUS] / radius < _RADIUS_RANGE[1]
    alike = p[CONTRAST] * difference > 0 and p[SPREAD] < 0.6 * p[RADIUS]
    clear = abs(p[CONTRAST]) > max(
        _SMALLEST_CONTRAST * np.sqrt(quality[NOISE_VARIANCE]), 0.02 * abs(p[LEVEL])
    )
    return p if near and sized and alike and clear and _is_round(p, quality) else None


def _is_round(p: np.ndarray, quality: np.ndarray) -> bool:
    """Whether what the disc leaves on its rim is small against its contrast."""
    residual = np.sqrt(max(quality[MISFIT], 0.0) * quality[NOISE_VARIANCE])
    return bool(residual < 0.15 * abs(p[CONTRAST]))


def _is_known(parameters: np.ndarray, found: list[np.ndarray]) -> bool:
    return any(
        np.hypot(parameters[X] - other[X], parameters[Y] - other[Y]) < 0.5 * other[RADIUS]
        for other in found
    )
