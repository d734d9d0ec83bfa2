r"""A blurred disc in uneven light, in pixels.

The light of a pixel at offset :math:`(x, y)` from the centre of the disc is

.. math:: I = (b + A\, F(R - \sqrt{x^2 + y^2})) (1 + h_x x + h_y y),

with a level b, a contrast A (negative: dark) and a shade that falls on disc and background alike.
Here :math:`F` is the response of a straight edge to the optics (Gaussian, standard deviation s)
and to the square pixel; its variance is :math:`S^2 = s^2 + 1/12` px² whatever the edge's direction
φ, its fourth cumulant :math:`-(\cos^4 φ + \sin^4 φ)/120`; an Edgeworth series to that order
replaces it. Where the picture is sharper than half a pixel, every pixel on the rim is divided into
smaller ones, which brings the series back to where it is valid.

The centre is insensitive to every error of shape that is symmetric about it: motion blur during an
even exposure, a disc seen at a slant.
"""

import math

import numpy as np
from scipy.special import ndtr

from softfinger.compiled import compiled

#: A disc's parameters: centre, contrast, radius, edge spread S, level, slopes of the shade.
PARAMETERS = ("x", "y", "contrast", "radius", "spread", "level", "slope_x", "slope_y")
X, Y, CONTRAST, RADIUS, SPREAD, LEVEL, SLOPE_X, SLOPE_Y = range(8)

PIXEL_VARIANCE = 1.0 / 12.0
SMALLEST_SPREAD = 0.95 * math.sqrt(PIXEL_VARIANCE)
LARGEST_SPREAD = 12.0

_NODES_PER_UNIT = 32
_LAST_UNIT = 5.0
_NODES = np.arange(-_LAST_UNIT, _LAST_UNIT + 0.5 / _NODES_PER_UNIT, 1.0 / _NODES_PER_UNIT)
_NORMAL_SHARE = ndtr(_NODES)
_NORMAL_DENSITY = np.exp(-0.5 * _NODES**2) / np.sqrt(2.0 * np.pi)


@compiled
def count_divisions(spread: float) -> int:
    """Sub-pixels a side for a negligible bias."""
    if spread >= 0.5:
        return 1
    if spread >= 0.4:
        return 2
    return 4 if spread >= 0.33 else 8


@compiled
def compute_edge_array(
    depth: float, spread: float, pixel_variance: float, evenness: float
) -> tuple[float, float]:
    r"""Light inside a straight edge, and its slope.

    Both are functions of the depth.

    .. math:: F = Φ(u) - φ(u) \frac{λ}{24} (u^3 - 3u), \quad u = d/S,
              \quad λ = -\frac{144\,p^2 (1 - 2 \cos^2 φ \sin^2 φ)}{120\, S^4}

    with p the pixel's variance along a side (1/12 px²).

    Parameters
    ----------
    depth, spread : float [px]
    pixel_variance : float [px2]
    evenness : float
        cos²φ sin²φ of the edge's direction.

    Examples
    --------
    >>> share, slope = compute_edge_array(0.0, 0.5, 1 / 12, 0.0)
    >>> share, round(slope, 4)
    (0.5, 0.7846)
    """
    sharpness = 1.0 / spread
    u = depth * sharpness
    if u >= _LAST_UNIT:
        return 1.0, 0.0
    if u <= -_LAST_UNIT:
        return 0.0, 0.0
    # Taylor series about the nearest node of the table: exact to 1e-8.
    node = int((u + _LAST_UNIT) * _NODES_PER_UNIT + 0.5)
    at = _NODES[node]
    off = u - at
    curve = at * at - 1.0
    density = _NORMAL_DENSITY[node]
    share = _NORMAL_SHARE[node] + density * off * (1.0 - off * (0.5 * at - off * curve / 6.0))
    density *= 1.0 - off * (at - off * 0.5 * curve)
    ratio = pixel_variance * sharpness * sharpness
    kurtosis = -0.05 * (1.0 - 2.0 * evenness) * ratio * ratio
    square = u * u
    return (
        share - density * kurtosis * u * (square - 3.0),
        density * sharpness * (1.0 + kurtosis * (square * (square - 6.0) + 3.0)),
    )


@compiled
def compute_response_array(
    dx: float, dy: float, radius: float, spread: float, divisions: int
) -> tuple[float, float, float, float, float]:
    """A pixel's share of disc light, with derivatives.

    Derivatives are by x, y, R and S.

    Parameters
    ----------
    dx, dy : float [px]
        Offset of the pixel's centre from the disc's.
    radius, spread : float [px]
        Radius of the disc and standard deviation of its edge, the pixel's own included.

    Examples
    --------
    Half of the light where the edge crosses the pixel:

    >>> share, *_ = compute_response_array(5.0, 0.0, 5.0, 0.6, 1)
    >>> round(share, 6)
    0.5
    """
    pixel = 1.0 / divisions
    pixel_variance = PIXEL_VARIANCE * pixel * pixel
    variance = spread * spread - PIXEL_VARIANCE + pixel_variance
    narrow = math.sqrt(max(variance, 0.9 * pixel_variance))
    share = by_x = by_y = by_radius = by_spread = 0.0
    for i in range(divisions):
        v = dy + (i + 0.5) * pixel - 0.5
        for j in range(divisions):
            u = dx + (j + 0.5) * pixel - 0.5
            r = math.sqrt(u * u + v * v) + 1e-9
            inverse = 1.0 / r
            c, s = u * inverse, v * inverse
            depth = radius - r
            part, slope = compute_edge_array(depth, narrow, pixel_variance, c * c * s * s)
            share += part
            by_x += slope * c
            by_y += slope * s
            by_radius += slope
            by_spread -= slope * depth
    area = pixel * pixel
    by_spread *= spread / (narrow * narrow)
    return share * area, by_x * area, by_y * area, by_radius * area, by_spread * area
