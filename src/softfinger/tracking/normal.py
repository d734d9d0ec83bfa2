"""Least squares of a disc over its window."""

import math

import numpy as np

from softfinger.compiled import compiled
from softfinger.tracking.disc import (
    CONTRAST,
    LEVEL,
    RADIUS,
    SLOPE_X,
    SLOPE_Y,
    SPREAD,
    X,
    Y,
    compute_response_array,
    count_divisions,
)
from softfinger.tracking.flat import INSIDE, OUTSIDE, add_pixels_array, compute_even_light

_RIM_WIDTH = 3.5  # half width of the rim in edge spreads


@compiled
def _compute_rim_width(spread: float) -> float:
    # Below the pixel's own width the edge spreads are no measure of the pixel's corners.
    return _RIM_WIDTH * spread + 0.5 * (spread < 0.5)


@compiled
def linearise_window_array(
    picture: np.ndarray,
    weight: np.ndarray,
    p: np.ndarray,
    margin: float,
    others: np.ndarray,
    own: int,
    rows: np.ndarray,
    flat: np.ndarray,
) -> int:
    """Residuals and derivatives in a disc's window.

    Parameters
    ----------
    picture : (row, column, channel)
    weight : (channel,)
        Light = Σ weight · channel.
    p : (8,)
        Parameters of the disc.
    margin : float [px]
        Width of the background in the window, beyond two edge spreads.
    others : (disc, 3) [px]
        Places and reaches of all discs; pixels of those other than `own` are left out.
    rows : (9, pixel)
        Overwritten: derivatives of the light of the rim's pixels by each parameter, with the shade
        held in place while the disc moves, and the residual.
    flat : (2, 10)
        Overwritten: sums over the pixels outside and inside, as in :mod:`softfinger.tracking.flat`.

    Returns
    -------
    int
        Number of pixels on the rim; −1 where they are more than `rows` has room for.
    """
    x, y, radius, spread = p[X], p[Y], p[RADIUS], p[SPREAD]
    width = _compute_rim_width(spread)
    outer, inner = radius + width, max(0.0, radius - width)
    reach = radius + 2.0 * spread + margin
    crowded = has_neighbours(x, y, reach, others, own)
    height, breadth = picture.shape[0], picture.shape[1]
    light_out, light_in = compute_even_light(p, OUTSIDE), compute_even_light(p, INSIDE)
    flat[:] = 0.0
    count = 0
    for i in range(max(0, math.ceil(y - reach)), min(height, math.floor(y + reach) + 1)):
        start, stop = find_chord(x, i - y, reach, 0, breadth)
        a, d = find_chord(x, i - y, outer, start, stop)
        b, c = find_chord(x, i - y, inner, a, d)
        if count + d - a > rows.shape[1]:
            return -1
        if crowded:
            for j in range(start, stop):
                if _is_taken(j, i, others, own):
                    continue
                if j < a or j >= d:
                    add_pixels_array(picture, weight, i, j, j + 1, x, y, light_out, flat[OUTSIDE])
                elif b <= j < c:
                    add_pixels_array(picture, weight, i, j, j + 1, x, y, light_in, flat[INSIDE])
                else:
                    _write_pixels(picture, weight, i, j, j + 1, p, rows, count)
                    count += 1
            continue
        add_pixels_array(picture, weight, i, start, a, x, y, light_out, flat[OUTSIDE])
        _write_pixels(picture, weight, i, a, b, p, rows, count)
        count += b - a
        add_pixels_array(picture, weight, i, b, c, x, y, light_in, flat[INSIDE])
        _write_pixels(picture, weight, i, c, d, p, rows, count)
        count += d - c
        add_pixels_array(picture, weight, i, d, stop, x, y, light_out, flat[OUTSIDE])
    return count


@compiled
def find_chord(x: float, dy: float, radius: float, first: int, end: int) -> tuple[int, int]:
    """Columns from, and before, which a circle crosses a row.

    They are between `first` and `end`. Where it does not cross, both are the middle: the pixels
    before and after it are outside.

    Examples
    --------
    >>> find_chord(5.2, 3.0, 5.0, 0, 20)
    (2, 10)
    """
    square = radius * radius - dy * dy
    half = math.sqrt(square) if square > 0.0 else -0.5
    start = min(max(first, math.ceil(x - half)), end)
    stop = max(start, min(end, math.floor(x + half) + 1))
    return start, stop


@compiled
def _write_pixels(
    picture: np.ndarray,
    weight: np.ndarray,
    row: int,
    first: int,
    end: int,
    p: np.ndarray,
    rows: np.ndarray,
    at: int,
) -> None:
    """Write pixels on the rim."""
    divisions, dy = count_divisions(p[SPREAD]), row - p[Y]
    for j in range(first, end):
        dx = j - p[X]
        response = compute_response_array(dx, dy, p[RADIUS], p[SPREAD], divisions)
        light = weight[0] * picture[row, j, 0]
        for k in range(1, weight.size):
            light += weight[k] * picture[row, j, k]
        _write_pixel(rows, at + j - first, p, dx, dy, response, light)


@compiled
def _write_pixel(
    rows: np.ndarray, at: int, p: np.ndarray, dx: float, dy: float, response: tuple, light: float
) -> None:
    share, by_x, by_y, by_radius, by_spread = response
    contrast, shade = p[CONTRAST], 1.0 + p[SLOPE_X] * dx + p[SLOPE_Y] * dy
    even = p[LEVEL] + contrast * share
    rows[X, at] = shade * contrast * by_x
    rows[Y, at] = shade * contrast * by_y
    rows[CONTRAST, at] = shade * share
    rows[RADIUS, at] = shade * contrast * by_radius
    rows[SPREAD, at] = shade * contrast * by_spread
    rows[LEVEL, at] = shade
    rows[SLOPE_X, at] = even * dx
    rows[SLOPE_Y, at] = even * dy
    rows[8, at] = light - shade * even


@compiled
def has_neighbours(x: float, y: float, reach: float, others: np.ndarray, own: int) -> bool:
    """Whether another disc reaches into a window."""
    for k in range(others.shape[0]):
        if k != own and math.hypot(x - others[k, 0], y - others[k, 1]) < reach + others[k, 2]:
            return True
    return False


@compiled
def _is_taken(column: int, row: int, others: np.ndarray, own: int) -> bool:
    for k in range(others.shape[0]):
        if k != own:
            dx, dy = column - others[k, 0], row - others[k, 1]
            if dx * dx + dy * dy < others[k, 2] * others[k, 2]:
                return True
    return False


@compiled
def multiply_rows_array(rows: np.ndarray, count: int, products: np.ndarray) -> None:
    """Scalar products of the rows, lower triangle.

    Only the first `count` columns count.

    In four sums side by side, and not by leave to reorder one sum: what a compiler makes of that
    leave changes with the code around it, and so would the last digits.

    >>> products = np.zeros((2, 2))
    >>> multiply_rows_array(np.array([[1.0, 2.0, 9.0], [3.0, 4.0, 9.0]]), 2, products)
    >>> products
    array([[ 5.,  0.],
           [11., 25.]])
    """
    whole = count - count % 4
    for a in range(rows.shape[0]):
        for b in range(a + 1):
            s0, s1, s2, s3 = 0.0, 0.0, 0.0, 0.0
            for k in range(0, whole, 4):
                s0 += rows[a, k] * rows[b, k]
                s1 += rows[a, k + 1] * rows[b, k + 1]
                s2 += rows[a, k + 2] * rows[b, k + 2]
                s3 += rows[a, k + 3] * rows[b, k + 3]
            for k in range(whole, count):
                s0 += rows[a, k] * rows[b, k]
            products[a, b] = (s0 + s1) + (s2 + s3)


@compiled
def invert_symmetric_array(normal: np.ndarray, low: np.ndarray, inverse: np.ndarray) -> bool:
    """Inverse of a positive matrix by Cholesky.

    Its lower triangle is given.

    Parameters
    ----------
    normal : (≥ n, ≥ n)
        Only its lower triangle is read.
    low, inverse : (n, n)
        Overwritten: the lower factor, and the inverse.

    Returns
    -------
    bool
        Whether the matrix is positive definite; otherwise `inverse` means nothing.
    """
    n = low.shape[0]
    for a in range(n):
        for b in range(a + 1):
            s = normal[a, b]
            for k in range(b):
                s -= low[a, k] * low[b, k]
            if a == b:
                if not s > 1e-12 * abs(normal[a, a]):
                    return False
                low[a, a] = math.sqrt(s)
            else:
                low[a, b] = s / low[b, b]
    for c in range(n):
        for a in range(c, n):
            s = 1.0 if a == c else 0.0
            for k in range(c, a):
                s -= low[a, k] * inverse[k, c]
            inverse[a, c] = s / low[a, a]
        for a in range(n - 1, c - 1, -1):
            s = inverse[a, c]
            for k in range(a + 1, n):
                s -= low[k, a] * inverse[k, c]
            inverse[a, c] = s / low[a, a]
            inverse[c, a] = inverse[a, c]
    return True
