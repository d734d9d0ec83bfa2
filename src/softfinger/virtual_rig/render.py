"""Pictures of the finger.

A picture is light × reflectance, blurred, with camera noise. A blurred disc is sampled exactly: its
radial profile (disc convolved with a Gaussian) is tabulated from a closed form, and the average
over each pixel's area is taken by 3 × 3 Gauss-Legendre points. All else is flat or straight-edged
and needs no such care.
"""

import math
from dataclasses import dataclass

import numpy as np
from scipy.special import chndtr, ndtri

from softfinger.compiled import compiled
from softfinger.virtual_rig.config import FilmConfig
from softfinger.virtual_rig.scene import FRAME_HEIGHT_PX, FRAME_WIDTH_PX

BACKGROUND_GREY = 150.0
BODY_GREY = 205.0
LIGHT_CENTRE_PX = (390.0, 190.0)
PROFILE_STEPS_PER_PX = 64
EDGE_SD = 5.0  # beyond so many sd of the blur an edge has ended
NOISE_LEVELS = 1 << 12
GAUSS_NODE = math.sqrt(0.6) / 2
GAUSS_WEIGHT = 5.0 / 18.0


@dataclass(frozen=True)
class Canvas:
    """What all pictures of a campaign share.

    Attributes
    ----------
    still : (row, column) float32 [grey]
        The lit background and the base.
    light : (row, column) float32
        Light relative to its brightest place.
    disc : (radius,) float64
        Share of dark at each radius of a mark, every 1 / PROFILE_STEPS_PER_PX pixels.
    disc_radius, blur, contrast
        [px], [px] and [grey].
    """

    still: np.ndarray
    light: np.ndarray
    disc: np.ndarray
    disc_radius: float
    blur: float
    contrast: float


def compute_disc_profile(disc_radius: float, blur: float) -> np.ndarray:
    """Compute a dark disc blurred by a Gaussian.

    The profile is taken against the distance r from the disc's centre.

    p(r) = P(|r e + blur · z| < R), z standard normal in the plane: the distribution function of a
    non-central χ² with two degrees of freedom.

    Returns
    -------
    (radius,)
        From r = 0 to beyond the blurred edge, PROFILE_STEPS_PER_PX to a pixel.

    Examples
    --------
    At the centre the Gaussian's share outside R is exp(−R²/2 blur²).

    >>> p = compute_disc_profile(2.0, 1.0)
    >>> round(float(p[0]), 4), round(1 - float(np.exp(-2.0)), 4)
    (0.8647, 0.8647)
    """
    count = math.ceil((disc_radius + EDGE_SD * blur) * PROFILE_STEPS_PER_PX) + 2
    radius = np.arange(count) / PROFILE_STEPS_PER_PX
    return chndtr((disc_radius / blur) ** 2, 2.0, (radius / blur) ** 2)


def build_light(unevenness: float) -> np.ndarray:
    """Build a lamp's light.

    It is brightest at LIGHT_CENTRE_PX: L = 1 − unevenness · ρ²/ρ²_max.

    Returns
    -------
    (row, column) float32
    """
    row, column = np.mgrid[:FRAME_HEIGHT_PX, :FRAME_WIDTH_PX]
    distance2 = (column - LIGHT_CENTRE_PX[0]) ** 2 + (row - LIGHT_CENTRE_PX[1]) ** 2
    return (1 - unevenness * distance2 / distance2.max()).astype(np.float32)


def build_canvas(config: FilmConfig, base: np.ndarray) -> Canvas:
    """Build all pictures' base (capsule, 5) [px]."""
    disc_radius = config.marker_diameter_m / config.metres_per_pixel / 2
    light = build_light(config.light_unevenness)
    canvas = Canvas(
        still=BACKGROUND_GREY * light,
        light=light,
        disc=compute_disc_profile(disc_radius, config.blur_px),
        disc_radius=disc_radius,
        blur=config.blur_px,
        contrast=config.marker_contrast_grey,
    )
    draw_finger(canvas.still, canvas, base, np.empty((0, 2)))
    return canvas


def draw_finger(
    picture: np.ndarray, canvas: Canvas, capsules: np.ndarray, markers: np.ndarray
) -> None:
    """Draw a finger's body and marks on a picture.

    The picture (row, column) float32 [grey] is changed in place.
    """
    edge_sd = math.hypot(canvas.blur, math.sqrt(1 / 12))  # a pixel's width adds 1/12 px²
    for capsule in capsules:
        _draw_capsule_array(picture, canvas.light, capsule, edge_sd, BODY_GREY)
    dark = BODY_GREY - canvas.contrast
    for x, y in markers:
        _draw_disc_array(picture, canvas.light, x, y, canvas.disc_radius, canvas.disc, dark)


@compiled
def _draw_capsule_array(
    picture: np.ndarray, light: np.ndarray, capsule: np.ndarray, edge_sd: float, grey: float
) -> None:
    x0, y0, x1, y1, half_thickness = capsule
    reach = half_thickness + EDGE_SD * edge_sd
    solid = max(0.0, half_thickness - EDGE_SD * edge_sd)
    rows, columns = picture.shape
    dx, dy = x1 - x0, y1 - y0
    length2 = dx * dx + dy * dy
    for row in range(max(0, int(min(y0, y1) - reach)), min(rows, int(max(y0, y1) + reach) + 2)):
        for column in range(
            max(0, int(min(x0, x1) - reach)), min(columns, int(max(x0, x1) + reach) + 2)
        ):
            px, py = column - x0, row - y0
            along = min(1.0, max(0.0, (px * dx + py * dy) / length2))
            distance2 = (px - along * dx) ** 2 + (py - along * dy) ** 2
            if distance2 >= reach * reach:
                continue
            cover = 1.0
            if distance2 > solid * solid:
                beyond = (math.sqrt(distance2) - half_thickness) / edge_sd
                cover = 0.5 * math.erfc(beyond / math.sqrt(2.0))
            picture[row, column] += (grey * light[row, column] - picture[row, column]) * cover


@compiled
def _draw_disc_array(
    picture: np.ndarray,
    light: np.ndarray,
    x: float,
    y: float,
    radius: float,
    disc: np.ndarray,
    grey: float,
) -> None:
    reach = (disc.size - 2) / PROFILE_STEPS_PER_PX
    solid = max(0.0, radius - (reach - radius) - 1.0)  # no blurred edge within a pixel
    rows, columns = picture.shape
    for row in range(max(0, int(y - reach) - 1), min(rows, int(y + reach) + 3)):
        for column in range(max(0, int(x - reach) - 1), min(columns, int(x + reach) + 3)):
            distance2 = (column - x) ** 2 + (row - y) ** 2
            if distance2 > (reach + 1.0) ** 2:
                continue
            cover = 1.0
            if distance2 > solid * solid:
                cover = _average_over_pixel_array(column - x, row - y, disc)
            picture[row, column] += (grey * light[row, column] - picture[row, column]) * cover


@compiled
def _average_over_pixel_array(dx: float, dy: float, disc: np.ndarray) -> float:
    total = 0.0
    for i in range(-1, 2):
        for j in range(-1, 2):
            weight = (GAUSS_WEIGHT if i else 8.0 / 18.0) * (GAUSS_WEIGHT if j else 8.0 / 18.0)
            distance = math.sqrt((dx + i * GAUSS_NODE) ** 2 + (dy + j * GAUSS_NODE) ** 2)
            step = distance * PROFILE_STEPS_PER_PX
            index = int(step)
            if index + 1 < disc.size:
                total += weight * (disc[index] + (step - index) * (disc[index + 1] - disc[index]))
    return total


def build_noise_table(noise_sd: float) -> np.ndarray:
    """Build equally likely values of a normal distribution.

    The distribution has the given sd [grey].

    The tails end at 3.7 sd.

    Returns
    -------
    (NOISE_LEVELS,) float32
    """
    quantile = ndtri((np.arange(NOISE_LEVELS) + 0.5) / NOISE_LEVELS)
    return (noise_sd * quantile / quantile.std()).astype(np.float32)


@compiled
def expose_array(
    picture: np.ndarray, noise_table: np.ndarray, key: np.uint64, frame: np.ndarray
) -> None:
    """Expose a frame.

    Noise, independent from pixel to pixel, is added, and the sum is rounded to 0…255.

    The random bits are SplitMix64's (Steele, Lea, Flood 2014, doi:10.1145/2660193.2660195) at the
    counters that follow ``key``; four pixels share 64 of them.

    Parameters
    ----------
    picture : (row, column) float32 [grey]
        The number of pixels is a multiple of four.
    noise_table : (NOISE_LEVELS,) float32 [grey]
    key
        64 random bits, another for each frame.
    frame : (row, column) uint8
        Written in place.
    """
    flat, out = picture.ravel(), frame.ravel()
    golden = np.uint64(0x9E3779B97F4A7C15)
    for block in range(flat.size // 4):
        bits = key + np.uint64(block) * golden
        bits = (bits ^ (bits >> np.uint64(30))) * np.uint64(0xBF58476D1CE4E5B9)
        bits = (bits ^ (bits >> np.uint64(27))) * np.uint64(0x94D049BB133111EB)
        bits ^= bits >> np.uint64(31)
        for lane in range(4):
            level = (bits >> np.uint64(16 * lane + 4)) & np.uint64(NOISE_LEVELS - 1)
            value = flat[4 * block + lane] + noise_table[level] + np.float32(0.5)
            out[4 * block + lane] = np.uint8(min(np.float32(255.0), max(np.float32(0.0), value)))
