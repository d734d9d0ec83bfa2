"""The fit of blurred discs to the pixels around their predicted places."""

import math

import numpy as np
from numba import njit

from softfinger.tracking.disc import (
    CONTRAST,
    LARGEST_SPREAD,
    LEVEL,
    RADIUS,
    SMALLEST_SPREAD,
    SPREAD,
    add_flat_pixels,
    add_rim_pixel,
    count_divisions,
)

#: What a fit measures beside the disc's parameters.
FIT_QUALITY = ("variance_x", "variance_y", "covariance_xy", "noise_variance", "misfit", "converged")
VARIANCE_X, VARIANCE_Y, COVARIANCE_XY, NOISE_VARIANCE, MISFIT, CONVERGED = range(6)

_RIM = 4.0  # half width of the rim in edge spreads
_MARGIN = 3.0  # pixels of plain background beyond the rim
_SMALLEST_RADIUS = 1.0


@njit(cache=True)
def solve_symmetric_array(normal, right):
    """Inverse of the symmetric positive matrix whose lower triangle is given, and the solution.

    Returns
    -------
    inverse (n, n), solution (n,), definite
        ``definite`` is False where the matrix has no Cholesky factor.
    """
    n = right.size
    low = np.zeros((n, n))
    inverse = np.zeros((n, n))
    solution = np.zeros(n)
    for a in range(n):
        for b in range(a + 1):
            s = normal[a, b]
            for k in range(b):
                s -= low[a, k] * low[b, k]
            if a == b:
                if not s > 1e-12 * abs(normal[a, a]):
                    return inverse, solution, False
                low[a, a] = math.sqrt(s)
            else:
                low[a, b] = s / low[b, b]
    for c in range(n):
        column = np.zeros(n)
        for a in range(c, n):
            s = 1.0 if a == c else 0.0
            for k in range(c, a):
                s -= low[a, k] * column[k]
            column[a] = s / low[a, a]
        for a in range(n - 1, -1, -1):
            s = column[a]
            for k in range(a + 1, n):
                s -= low[k, a] * inverse[k, c]
            inverse[a, c] = s / low[a, a]
    for a in range(n):
        for b in range(n):
            solution[a] += inverse[a, b] * right[b]
    return inverse, solution, True


@njit(cache=True)
def _read_light(frame, i, j, weight):
    value = 0.0
    for k in range(weight.size):
        value += weight[k] * frame[i, j, k]
    return value


@njit(cache=True)
def _is_taken(column, row, others, own):
    """Whether a pixel belongs to another disc (x, y, reach) of the list."""
    for k in range(others.shape[0]):
        if k != own:
            dx, dy = column - others[k, 0], row - others[k, 1]
            if dx * dx + dy * dy < others[k, 2] * others[k, 2]:
                return True
    return False


@njit(cache=True)
def accumulate_window_array(frame, weight, p, others, own, normal, right):
    """Normal equations of one disc over its window, and the squares of its residuals.

    Returns
    -------
    (flat_sum, flat_count, rim_sum, rim_count)
        Sums of squared residuals over pixels off the rim, and on it.
    """
    normal[:] = 0.0
    right[:] = 0.0
    radius, spread = p[RADIUS], p[SPREAD]
    width = _RIM * spread + 0.5 * (spread < 0.5)
    reach = radius + max(width, 3.0 * spread + _MARGIN)
    outer = (radius + width) ** 2
    inner = max(0.0, radius - width) ** 2
    divisions = count_divisions(spread)
    row = np.empty(8)
    flat = np.zeros((2, 9))
    rim_sum, rim_count, flat_sum = 0.0, 0, 0.0
    top, bottom = max(0, math.ceil(p[1] - reach)), min(frame.shape[0] - 1, math.floor(p[1] + reach))
    left, end = max(0, math.ceil(p[0] - reach)), min(frame.shape[1] - 1, math.floor(p[0] + reach))
    for i in range(top, bottom + 1):
        dy = i - p[1]
        for j in range(left, end + 1):
            dx = j - p[0]
            square = dx * dx + dy * dy
            if square > reach * reach or _is_taken(j, i, others, own):
                continue
            value = _read_light(frame, i, j, weight)
            if inner < square < outer:
                rim_sum += add_rim_pixel(value, dx, dy, p, divisions, row, normal, right)
                rim_count += 1
                continue
            inside = 1 if square <= inner else 0
            r = value - (p[LEVEL] + p[6] * dx + p[7] * dy + p[CONTRAST] * inside)
            flat_sum += r * r
            sums = flat[inside]
            sums[0] += 1.0
            sums[1] += dx
            sums[2] += dy
            sums[3] += dx * dx
            sums[4] += dx * dy
            sums[5] += dy * dy
            sums[6] += r
            sums[7] += r * dx
            sums[8] += r * dy
    for inside in range(2):
        add_flat_pixels(flat[inside], p, float(inside), normal, right)
    return flat_sum, flat[0, 0] + flat[1, 0], rim_sum, rim_count


@njit(cache=True)
def fit_disc_array(frame, weight, p, others, own, quality, iterations, tolerance):
    """Fit one blurred disc by Gauss–Newton, starting from `p`, which is overwritten.

    Parameters
    ----------
    frame : (row, column, channel)
        The picture.
    weight : (channel,)
        Light = Σ weight · channel.
    p : (8,)
        Parameters in the order of :data:`softfinger.tracking.disc.PARAMETERS`.
    others : (disc, 3)
        Places and reaches of all discs; pixels of the others are left out.
    own : int
        This disc's row in `others`.
    quality : (6,)
        Filled, in the order of :data:`FIT_QUALITY`; variances for the noise found off the rim.
        `misfit` is the mean square residual on the rim over that off it.
    iterations : int
        At most so many steps.
    tolerance : float [px]
        A centre that moves less has converged.

    Returns
    -------
    bool
        Whether the fit converged.
    """
    normal, right = np.empty((8, 8)), np.empty(8)
    quality[:] = np.nan
    quality[CONVERGED] = 0.0
    for _ in range(iterations):
        flat_sum, flat_count, rim_sum, rim_count = accumulate_window_array(
            frame, weight, p, others, own, normal, right
        )
        if rim_count < 12 or flat_count < 8:
            return False
        if p[SPREAD] <= SMALLEST_SPREAD:
            # At the pixel's own sharpness a still sharper edge is no parameter any more.
            for k in range(8):
                normal[max(k, SPREAD), min(k, SPREAD)] = 0.0
            normal[SPREAD, SPREAD] = 1.0
            right[SPREAD] = max(right[SPREAD], 0.0) / max(1.0, normal[RADIUS, RADIUS])
        inverse, step, definite = solve_symmetric_array(normal, right)
        if not definite:
            return False
        moved = math.hypot(step[0], step[1])
        share = min(1.0, 0.5 * p[RADIUS] / max(moved, 1e-9))
        for k in range(8):
            p[k] += share * step[k]
        p[RADIUS] = max(p[RADIUS], _SMALLEST_RADIUS)
        p[SPREAD] = min(max(p[SPREAD], SMALLEST_SPREAD), LARGEST_SPREAD)
        if moved < tolerance:
            noise = flat_sum / max(1.0, flat_count - 3.0)
            quality[VARIANCE_X] = noise * inverse[0, 0]
            quality[VARIANCE_Y] = noise * inverse[1, 1]
            quality[COVARIANCE_XY] = noise * inverse[0, 1]
            quality[NOISE_VARIANCE] = noise
            quality[MISFIT] = (rim_sum / rim_count) / max(noise, 1e-12)
            quality[CONVERGED] = 1.0
            return True
    return False
