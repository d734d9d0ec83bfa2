r"""A blurred disc on a sloping background, and its fit to a few pixels by Gauss–Newton.

The light of a pixel at offset :math:`(x, y)` from the centre of the disc is

.. math:: I = b_0 + b_x x + b_y y + A\, F(R - \sqrt{x^2 + y^2}),

where :math:`F` is the response of a straight edge to the optics (Gaussian) and to the square pixel.
Its variance is :math:`S^2 = s^2 + 1/12` px² whatever the edge's direction φ, its fourth cumulant
:math:`-(\cos^4 φ + \sin^4 φ)/120`; an Edgeworth series to that order stands for it. Where the
picture is sharper than half a pixel, every pixel on the rim is divided into smaller ones, which
brings the series back to where it holds.

The centre is insensitive to every error of shape that is symmetric about it: motion blur during an
even exposure, a disc seen at a slant.
"""

import math

from numba import njit

#: The order of a disc's parameters: centre, contrast, radius, edge spread S, background and slope.
PARAMETERS = ("x", "y", "contrast", "radius", "spread", "level", "slope_x", "slope_y")
X, Y, CONTRAST, RADIUS, SPREAD, LEVEL, SLOPE_X, SLOPE_Y = range(8)

PIXEL_VARIANCE = 1.0 / 12.0
SMALLEST_SPREAD = 0.95 * math.sqrt(PIXEL_VARIANCE)
LARGEST_SPREAD = 12.0
_REACH = 4.0  # edge spreads beyond which a pixel is wholly in or wholly out


@njit(cache=True, inline="always")
def _edge(depth, spread_squared, pixel_squared, evenness):
    """Share of light and its slope, at `depth` inside a straight edge, for a pixel of a given area.

    `evenness` is cos²φ sin²φ of the edge's direction φ.
    """
    spread = math.sqrt(spread_squared)
    u = depth / spread
    u2 = u * u
    density = math.exp(-0.5 * u2) * 0.3989422804014327
    kurtosis = -(1.0 - 2.0 * evenness) * (pixel_squared / spread_squared) ** 2 / 120.0
    share = 0.5 * math.erfc(-u * 0.7071067811865476) - density * kurtosis / 24.0 * u * (u2 - 3.0)
    slope = density / spread * (1.0 + kurtosis / 24.0 * (u2 * (u2 - 6.0) + 3.0))
    return share, slope


@njit(cache=True)
def count_divisions(spread):
    """Sub-pixels along a side that keep the series within 1e-3 of the exact edge."""
    if spread >= 0.5:
        return 1
    return 2 if spread >= 0.4 else 5


@njit(cache=True)
def compute_disc_response_array(dx, dy, radius, spread, divisions):
    """Share of a pixel's light that comes from the disc, and its derivatives by x, y, R, S.

    Parameters
    ----------
    dx, dy : float
        Offset of the pixel's centre from the disc's [px].
    radius, spread : float
        Radius of the disc and standard deviation of its edge, the pixel's own included [px].
    divisions : int
        Sub-pixels along a side.

    Returns
    -------
    tuple of five floats
        Share, and its derivatives by the centre's x and y, by radius and by spread [1/px].

    Examples
    --------
    Half of the light where the edge crosses the pixel:

    >>> share, *_ = compute_disc_response_array(5.0, 0.0, 5.0, 0.6, 1)
    >>> round(share, 12)
    0.5
    """
    pixel = 1.0 / divisions
    variance = spread * spread - PIXEL_VARIANCE * (1.0 - pixel * pixel)
    variance = max(variance, 0.9 * PIXEL_VARIANCE * pixel * pixel)
    share = by_x = by_y = by_radius = by_spread = 0.0
    for i in range(divisions):
        v = dy + (i + 0.5) * pixel - 0.5
        for j in range(divisions):
            u = dx + (j + 0.5) * pixel - 0.5
            r = math.sqrt(u * u + v * v) + 1e-9
            c, s = u / r, v / r
            depth = radius - r
            part, slope = _edge(depth, variance, pixel * pixel, c * c * s * s)
            share += part
            by_x += slope * c
            by_y += slope * s
            by_radius += slope
            by_spread -= slope * depth / variance * spread
    area = pixel * pixel
    return share * area, by_x * area, by_y * area, by_radius * area, by_spread * area


@njit(cache=True)
def add_rim_pixel(value, dx, dy, p, divisions, row, normal, right):
    """Add one pixel on the rim to the normal equations; return its squared residual."""
    share, by_x, by_y, by_r, by_s = compute_disc_response_array(
        dx, dy, p[RADIUS], p[SPREAD], divisions
    )
    contrast = p[CONTRAST]
    residual = value - (p[LEVEL] + p[SLOPE_X] * dx + p[SLOPE_Y] * dy + contrast * share)
    row[0] = contrast * by_x - p[SLOPE_X]
    row[1] = contrast * by_y - p[SLOPE_Y]
    row[2] = share
    row[3] = contrast * by_r
    row[4] = contrast * by_s
    row[5] = 1.0
    row[6] = dx
    row[7] = dy
    for a in range(8):
        right[a] += row[a] * residual
        for b in range(a + 1):
            normal[a, b] += row[a] * row[b]
    return residual * residual


@njit(cache=True)
def add_flat_pixels(sums, p, inside, normal, right):
    """Add pixels wholly in (or out of) the disc, whose share is constant, from their moments."""
    n, sx, sy, sxx, sxy, syy, sr, srx, sry = sums
    gx, gy = -p[SLOPE_X], -p[SLOPE_Y]
    # The row of such a pixel is (gx, gy, inside, 0, 0, 1, dx, dy).
    constant = (gx, gy, inside, 0.0, 0.0, 1.0)
    for a in range(6):
        right[a] += constant[a] * sr
        for b in range(a + 1):
            normal[a, b] += constant[a] * constant[b] * n
        normal[6, a] += constant[a] * sx
        normal[7, a] += constant[a] * sy
    normal[6, 6] += sxx
    normal[7, 6] += sxy
    normal[7, 7] += syy
    right[6] += srx
    right[7] += sry
