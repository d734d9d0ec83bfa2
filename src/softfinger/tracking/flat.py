r"""Pixels of a disc's window that are wholly outside or inside the disc.

Their light is even up to the shade, :math:`I = e (1 + h_x x + h_y y)` with e the level outside and
level plus contrast inside. So a few sums over them serve the least squares, whatever their number:
counts and products of the offsets, and the same weighted by the light above e.
"""

import numpy as np

from softfinger.compiled import compiled
from softfinger.tracking.disc import CONTRAST, LEVEL, SLOPE_X, SLOPE_Y

#: Sums over pixels: 1, dx, dy, their products; the excess of light over e, by dx, by dy, squared.
SUMS = ("n", "x", "y", "xx", "xy", "yy", "l", "lx", "ly", "ll")
_N, _X, _Y, _XX, _XY, _YY, _L, _LX, _LY, _LL = range(len(SUMS))
OUTSIDE, INSIDE = range(2)
_RESIDUAL = 8  # the row of the residual among the products


@compiled
def compute_even_light(p: np.ndarray, place: int) -> float:
    """The light e of a place, before the shade."""
    return p[LEVEL] + (p[CONTRAST] if place == INSIDE else 0.0)


@compiled
def add_pixels_array(
    picture: np.ndarray,
    weight: np.ndarray,
    row: int,
    first: int,
    end: int,
    x: float,
    y: float,
    even: float,
    sums: np.ndarray,
) -> None:
    """Add the pixels `first` to `end` − 1 of a row.

    Parameters
    ----------
    picture : (row, column, channel)
    weight : (channel,)
        Light = Σ weight · channel.
    x, y : float [px]
        The disc's centre.
    even : float
        The light e.
    sums : (10,)
        Added to, in the order of :data:`SUMS`.
    """
    n = end - first
    if n <= 0:
        return
    dy, middle = row - y, 0.5 * (first + end - 1) - x
    light = along = square = 0.0
    for j in range(first, end):
        excess = weight[0] * picture[row, j, 0] - even
        for k in range(1, weight.size):
            excess += weight[k] * picture[row, j, k]
        light += excess
        along += excess * (j - first)
        square += excess * excess
    sums[_N] += n
    sums[_X] += n * middle
    sums[_Y] += n * dy
    sums[_XX] += n * (middle * middle + (n * n - 1.0) / 12.0)
    sums[_XY] += n * middle * dy
    sums[_YY] += n * dy * dy
    sums[_L] += light
    sums[_LX] += along + (first - x) * light
    sums[_LY] += dy * light
    sums[_LL] += square


@compiled
def add_products_array(sums: np.ndarray, p: np.ndarray, place: int, products: np.ndarray) -> None:
    """Add a place's scalar products of derivatives and residual.

    Parameters
    ----------
    sums : (10,)
    p : (8,)
        The disc's parameters with which the sums were made.
    place : int
        :data:`OUTSIDE` or :data:`INSIDE`.
    products : (9, 9)
        Lower triangle, added to; the last row is that of the residual.
    """
    a, b, even = p[SLOPE_X], p[SLOPE_Y], compute_even_light(p, place)
    x = sums[_X] + a * sums[_XX] + b * sums[_XY]  # Σ shade · dx
    y = sums[_Y] + a * sums[_XY] + b * sums[_YY]
    one = sums[_N] + a * sums[_X] + b * sums[_Y]
    shade = one + a * x + b * y  # Σ shade²
    rest_x = sums[_LX] - even * (x - sums[_X])  # Σ residual · dx
    rest_y = sums[_LY] - even * (y - sums[_Y])
    rest = sums[_L] - even * (one - sums[_N]) + a * rest_x + b * rest_y  # Σ residual · shade
    lean = a * sums[_LX] + b * sums[_LY]
    bend = a * (x - sums[_X]) + b * (y - sums[_Y])
    for k in (CONTRAST, LEVEL):
        if k == CONTRAST and place == OUTSIDE:
            continue
        products[k, k] += shade
        products[SLOPE_X, k] += even * x
        products[SLOPE_Y, k] += even * y
        products[_RESIDUAL, k] += rest
    if place == INSIDE:
        products[LEVEL, CONTRAST] += shade
    products[SLOPE_X, SLOPE_X] += even * even * sums[_XX]
    products[SLOPE_Y, SLOPE_X] += even * even * sums[_XY]
    products[SLOPE_Y, SLOPE_Y] += even * even * sums[_YY]
    products[_RESIDUAL, SLOPE_X] += even * rest_x
    products[_RESIDUAL, SLOPE_Y] += even * rest_y
    products[_RESIDUAL, _RESIDUAL] += sums[_LL] - even * (2.0 * lean - even * bend)


@compiled
def measure_rest_array(
    sums: np.ndarray, p: np.ndarray, place: int, step: np.ndarray, room: np.ndarray
) -> float:
    """Sum of squared residuals after a step from `p`."""
    room[:] = 0.0
    add_products_array(sums, p, place, room)
    rest = room[_RESIDUAL, _RESIDUAL]
    for a in range(step.size):
        rest -= 2.0 * step[a] * room[_RESIDUAL, a]
        for b in range(a + 1):
            rest += (1.0 if a == b else 2.0) * step[a] * step[b] * room[a, b]
    return max(rest, 0.0)
