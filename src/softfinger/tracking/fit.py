"""Gauss–Newton fit of one blurred disc."""

import math

import numpy as np

from softfinger.compiled import compiled
from softfinger.tracking.disc import (
    CONTRAST,
    LARGEST_SPREAD,
    LEVEL,
    PARAMETERS,
    RADIUS,
    SLOPE_X,
    SLOPE_Y,
    SMALLEST_SPREAD,
    SPREAD,
    X,
    Y,
)
from softfinger.tracking.flat import INSIDE, OUTSIDE, add_products_array, measure_rest_array
from softfinger.tracking.normal import (
    invert_symmetric_array,
    linearise_window_array,
    multiply_rows_array,
)

#: What a fit gives beside the disc's parameters: variances of the centre for light noise of
#: variance 1, that noise's variance, and the mean square residual on the rim over it.
FIT_QUALITY = ("unit_xx", "unit_yy", "unit_xy", "noise_variance", "misfit")
UNIT_XX, UNIT_YY, UNIT_XY, NOISE_VARIANCE, MISFIT = range(5)

#: A step smaller than this, in edge spreads, is the last one. By symmetry a step of length δ
#: leaves an error of order δ³: far below the noise.
LAST_STEP = 0.05
#: Widths of background to fit with: the wider, the better the shade is known; the narrower, the
#: less often something else is in the window.
MARGINS = (1.5, 2.5, 4.0, 6.0)
LARGEST_WINDOW = 20_000  # pixels: a radius of about 75

_SIZE = len(PARAMETERS)
# Where noise is strong and the picture sharp, whole steps may go to and fro for ever. Shorter and
# shorter ones end in the middle, and a spread that still wavers does the centre no harm.
_WHOLE_STEPS = 8
_SMALLEST_RADIUS = 1.0
_MOST_GROWTH = 2.5  # radii of the start: what grows or strays further is no disc of that kind
_FEWEST_RIM, _FEWEST_FLAT = 12, 8


@compiled
def fit_disc_array(
    picture: np.ndarray,
    weight: np.ndarray,
    p: np.ndarray,
    margin: float,
    others: np.ndarray,
    own: int,
    quality: np.ndarray,
    rows: np.ndarray,
    flat: np.ndarray,
    iterations: int,
) -> bool:
    """Fit one blurred disc by Gauss–Newton, starting from `p`.

    Parameters
    ----------
    picture : (row, column, channel)
    weight : (channel,)
        Light = Σ weight · channel.
    p : (8,)
        Overwritten; in the order of :data:`softfinger.tracking.disc.PARAMETERS`.
    margin : float [px]
        Width of the background in the window, beyond two edge spreads.
    others : (disc, 3) [px]
        Places and reaches of all discs; pixels of those other than `own` are left out.
    quality : (5,)
        Overwritten; in the order of :data:`FIT_QUALITY`, NaN where the fit fails.
    rows, flat : (9, pixel), (2, 10)
        Room to work in.
    iterations : int
        At most so many steps.
    """
    products = np.empty((_SIZE + 1, _SIZE + 1))
    low, inverse, step = np.empty((_SIZE, _SIZE)), np.empty((_SIZE, _SIZE)), np.empty(_SIZE)
    before = np.empty(_SIZE)
    quality[:] = np.nan
    widest = _MOST_GROWTH * p[RADIUS]
    first_x, first_y = p[X], p[Y]
    for k in range(iterations):
        count = linearise_window_array(picture, weight, p, margin, others, own, rows, flat)
        if count <= 0:
            return False
        if not _solve_step(p, rows, flat, count, products, low, inverse, step):
            return False
        whole = k < _WHOLE_STEPS
        moved = math.hypot(step[X], step[Y])
        reshaped = max(abs(step[RADIUS]), abs(step[SPREAD])) if whole else 0.0
        share = min(
            1.0 if whole else 1.0 / (k - _WHOLE_STEPS + 2),
            0.5 * p[RADIUS] / max(moved, 1e-9),
            0.3 * p[RADIUS] / max(abs(step[RADIUS]), 1e-9),
            0.5 * p[SPREAD] / max(abs(step[SPREAD]), 1e-9),
        )
        last = max(moved, reshaped) < LAST_STEP * p[SPREAD]
        before[:] = p
        _take_step(p, step, share)
        strayed = math.hypot(p[X] - first_x, p[Y] - first_y) > widest
        if strayed or p[RADIUS] > widest or p[SPREAD] > 0.5 * widest:
            return False
        if last:
            quality[UNIT_XX], quality[UNIT_YY] = inverse[X, X], inverse[Y, Y]
            quality[UNIT_XY] = inverse[X, Y]
            return _measure_residuals(rows, flat, before, step, count, quality)
    return False


@compiled
def _solve_step(
    p: np.ndarray,
    rows: np.ndarray,
    flat: np.ndarray,
    count: int,
    products: np.ndarray,
    low: np.ndarray,
    inverse: np.ndarray,
    step: np.ndarray,
) -> bool:
    """Solve for the step that least squares asks for."""
    multiply_rows_array(rows, count, products)
    for place in (OUTSIDE, INSIDE):
        add_products_array(flat[place], p, place, products)
    if p[SPREAD] <= SMALLEST_SPREAD and products[_SIZE, SPREAD] <= 0.0:
        _hold_spread(products)
    if not invert_symmetric_array(products, low, inverse):
        return False
    for a in range(_SIZE):
        step[a] = 0.0
        for b in range(_SIZE):
            step[a] += inverse[a, b] * products[_SIZE, b]
    return True


@compiled
def _take_step(p: np.ndarray, step: np.ndarray, share: float) -> None:
    for a in range(p.size):
        p[a] += share * step[a]
    # The shade stays in place: its value at the new centre goes into level and contrast.
    shade = 1.0 + share * (step[X] * p[SLOPE_X] + step[Y] * p[SLOPE_Y])
    p[LEVEL] *= shade
    p[CONTRAST] *= shade
    p[SLOPE_X] /= shade
    p[SLOPE_Y] /= shade
    p[RADIUS] = max(p[RADIUS], _SMALLEST_RADIUS)
    p[SPREAD] = min(max(p[SPREAD], SMALLEST_SPREAD), LARGEST_SPREAD)


@compiled
def _hold_spread(products: np.ndarray) -> None:
    """Fix the spread, at the pixel's own sharpness."""
    for k in range(_SIZE + 1):
        products[max(k, SPREAD), min(k, SPREAD)] = 0.0
    products[SPREAD, SPREAD] = 1.0


@compiled
def _measure_residuals(
    rows: np.ndarray,
    flat: np.ndarray,
    before: np.ndarray,
    step: np.ndarray,
    count: int,
    quality: np.ndarray,
) -> bool:
    """Noise off the rim and misfit on it.

    Both are those after the last step, which went from `before`.

    The noise on the rim is taken midway between that of the light outside and that inside, so that
    no error of the disc's shape counts as noise. Of the eight parameters half are at home on the
    rim; where the window has no other pixels, what is left there is taken for noise.
    """
    if count < _FEWEST_RIM:
        return False
    on_rim = 0.0
    for k in range(count):
        r = rows[_SIZE, k]
        for a in range(_SIZE):
            r -= rows[a, k] * step[a]
        on_rim += r * r
    on_rim /= count - 4
    noise, sides, room = 0.0, 0, np.empty((_SIZE + 1, _SIZE + 1))
    for place, parameters in ((OUTSIDE, 3), (INSIDE, 1)):  # level, slopes outside; contrast inside
        number = flat[place, 0]
        if number >= _FEWEST_FLAT:
            rest = measure_rest_array(flat[place], before, place, step, room)
            noise += rest / (number - parameters)
            sides += 1
    quality[NOISE_VARIANCE] = noise / sides if sides else on_rim
    quality[MISFIT] = on_rim / max(quality[NOISE_VARIANCE], 1e-12)
    return True
