"""Polarity, colour and channel mix of markers."""

import cv2
import numpy as np

from softfinger.tracking.disc import CONTRAST, LEVEL, RADIUS, SLOPE_X, SLOPE_Y, SPREAD, X, Y

POLARITY = {"dark": -1, "light": 1}
_INSIDE, _FROM, _TO = 0.6, 1.3, 2.0  # radii: a disc's own light, and its surroundings
_RIDGE = 0.1  # of the mean channel variance: channels of a grey picture have one noise


def choose_polarity(colour: str | None) -> int:
    """Polarity: −1 dark, +1 light, 0 either."""
    if colour is not None and colour.startswith("#"):
        return 1
    return POLARITY.get(colour or "", 0)


def draw_closeness(picture: np.ndarray, colour: str) -> np.ndarray:
    """Light that rises towards a declared colour.

    It is 255 where a pixel has that colour.

    Hue and saturation count twice as much as brightness, which the light decides.

    Parameters
    ----------
    picture : (row, column, 3)
        Blue, green, red.
    colour : str
        ``#rrggbb``.

    Returns
    -------
    (row, column, 1) uint8

    Examples
    --------
    >>> draw_closeness(np.array([[[0, 0, 255], [255, 255, 255]]], np.uint8), "#ff0000").ravel()
    array([255,   0], dtype=uint8)
    """
    wanted = np.array([int(colour[k : k + 2], 16) for k in (5, 3, 1)], np.float32)
    grey = np.full((3, 3), 1.0 / 3.0)
    mix = (2.0 * (np.eye(3) - grey) + grey).astype(np.float32)
    off = cv2.transform(picture.astype(np.float32) - wanted, mix)
    distance = np.sqrt(cv2.transform(off * off, np.ones((1, 3), np.float32)))
    return np.clip(255.0 - distance, 0.0, 255.0).astype(np.uint8)[:, :, None]


def choose_weight(picture: np.ndarray, discs: np.ndarray) -> np.ndarray:
    r"""Mix of channels that shows the discs best.

    Contrast counts in units of the noise around the discs.

    :math:`w ∝ Σ^{-1} c` with c the mean difference of a disc's light from its surroundings and Σ
    the covariance of the channels there, scaled so that :math:`Σ|w| = 1` and the discs keep the
    sign of their contrast.

    Parameters
    ----------
    picture : (row, column, channel)
    discs : (disc, 8)
        As fitted in any mix of the channels.

    Returns
    -------
    (channel,)
    """
    channels = picture.shape[2]
    if channels == 1:
        return np.ones(1)
    difference, covariance = np.zeros(channels), np.zeros((channels, channels))
    for disc in discs:
        inside, around = _sample(picture, disc)
        if len(inside) < 3 or len(around) <= channels:
            continue
        difference += inside.mean(axis=0) - around.mean(axis=0)
        covariance += np.cov(around.T)
    ridge = _RIDGE * np.trace(covariance) / channels + 1e-3
    weight = np.linalg.solve(covariance + ridge * np.eye(channels), difference)
    total = np.abs(weight).sum()
    if not total > 0.0:
        return np.full(channels, 1.0 / channels)
    return weight / total * (np.sign(np.median(discs[:, CONTRAST])) if len(discs) else 1.0)


def measure_light(picture: np.ndarray, weight: np.ndarray, discs: np.ndarray) -> np.ndarray:
    """Discs (disc, 8), their light in another channel mix.

    Contrast and level change; the other columns stay.
    """
    measured = discs.copy()
    for disc in measured:
        inside, around = _sample(picture, disc)
        if len(inside) and len(around):
            level = around.mean(axis=0) @ weight
            disc[CONTRAST], disc[LEVEL] = inside.mean(axis=0) @ weight - level, level
            disc[[SLOPE_X, SLOPE_Y]] = 0.0
    return measured


def _sample(picture: np.ndarray, disc: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Pixels (pixel, channel) inside and around a disc."""
    reach = _TO * disc[RADIUS] + disc[SPREAD]
    top, left = max(0, int(disc[Y] - reach)), max(0, int(disc[X] - reach))
    window = picture[top : int(disc[Y] + reach) + 2, left : int(disc[X] + reach) + 2]
    rows, columns = np.indices(window.shape[:2])
    radius = np.hypot(columns + left - disc[X], rows + top - disc[Y]) / disc[RADIUS]
    light = window.astype(float)
    return light[radius < _INSIDE], light[(radius > _FROM) & (radius < _TO)]
