"""Find discs anywhere: tracking's start and restart."""

import cv2
import numpy as np

from softfinger.tracking.disc import CONTRAST, RADIUS, SPREAD, X, Y
from softfinger.tracking.fit import FIT_QUALITY, LARGEST_WINDOW, MARGINS, fit_disc_array
from softfinger.tracking.flat import SUMS
from softfinger.tracking.follow import is_certain_array

_SMALL_RADIUS = 4.0  # px: discs are looked for in a picture so far shrunk
_RADIUS_RANGE = (0.6, 1.6)
_ITERATIONS = 15
_MOST_CANDIDATES = 200
_NO_DISCS = np.empty((0, 3))


def find_discs_array(
    picture: np.ndarray, weight: np.ndarray, radius: float, polarity: int
) -> np.ndarray:
    """Every disc of about a radius in a picture.

    The light may be uneven.

    Places where the picture differs most from its surroundings (a difference of two Gaussian
    means, which no even slope of light can imitate) are fitted by blurred discs.

    Parameters
    ----------
    picture : (row, column, channel)
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
    difference, size = _draw_difference(picture, weight, radius)
    found: list[np.ndarray] = []
    for row, column in _list_peaks(difference, polarity, radius / size):
        place = (size * (np.array([column, row]) + 0.5) - 0.5).astype(int)
        parameters = _fit_anywhere(picture, weight, *place, radius, difference[row, column])
        if parameters is not None and not _is_known(parameters, found):
            found.append(parameters)
    found.sort(key=lambda p: -abs(p[CONTRAST]))
    return np.array(found).reshape(-1, 8)


def _draw_difference(
    picture: np.ndarray, weight: np.ndarray, radius: float
) -> tuple[np.ndarray, int]:
    """Difference of two Gaussian means; its pixel width."""
    size = max(1, int(radius / _SMALL_RADIUS))
    light = cv2.transform(picture.astype(np.float32), weight[None].astype(np.float32))
    if size > 1:
        small = (light.shape[1] // size, light.shape[0] // size)
        light = cv2.resize(
            light[: small[1] * size, : small[0] * size], small, interpolation=cv2.INTER_AREA
        )
    narrow = cv2.GaussianBlur(light, (0, 0), 0.6 * radius / size)
    return narrow - cv2.GaussianBlur(light, (0, 0), 1.5 * radius / size), size


def _list_peaks(difference: np.ndarray, polarity: int, radius: float) -> np.ndarray:
    strength = np.abs(difference) if polarity == 0 else polarity * difference
    size = 2 * max(1, round(0.7 * radius)) + 1
    highest = cv2.dilate(strength, np.ones((size, size), np.uint8))
    typical = 1.4826 * np.median(np.abs(difference))
    rows, columns = np.nonzero((strength == highest) & (strength > max(1.0, 4.0 * typical)))
    order = np.argsort(-strength[rows, columns], kind="stable")[:_MOST_CANDIDATES]
    return np.stack([rows[order], columns[order]], axis=1)


def _fit_anywhere(
    picture: np.ndarray,
    weight: np.ndarray,
    column: int,
    row: int,
    radius: float,
    difference: float,
) -> np.ndarray | None:
    """Fit a disc at a peak, else None."""
    reach = 2 * radius
    around = picture[
        max(0, int(row - reach)) : int(row + reach) + 1,
        max(0, int(column - reach)) : int(column + reach) + 1,
    ].astype(float)
    level = float(np.median(around @ weight))
    p = np.array([column, row, 2.2 * difference, radius, 1.0, level, 0.0, 0.0])
    quality = np.empty(len(FIT_QUALITY))
    rows, flat = np.empty((9, LARGEST_WINDOW)), np.empty((2, len(SUMS)))
    start = (p, MARGINS[0], _NO_DISCS, -1)
    if not fit_disc_array(picture, weight, *start, quality, rows, flat, _ITERATIONS):
        return None
    near = np.hypot(p[X] - column, p[Y] - row) < radius
    sized = _RADIUS_RANGE[0] < p[RADIUS] / radius < _RADIUS_RANGE[1]
    alike = p[CONTRAST] * difference > 0 and p[SPREAD] < 0.6 * p[RADIUS]
    return p if near and sized and alike and is_certain_array(p, quality) else None


def _is_known(parameters: np.ndarray, found: list[np.ndarray]) -> bool:
    return any(
        np.hypot(parameters[X] - other[X], parameters[Y] - other[Y]) < 0.5 * other[RADIUS]
        for other in found
    )
