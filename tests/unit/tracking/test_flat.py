"""Sums over flat pixels, beside derivatives and residuals written out pixel by pixel."""

import numpy as np
import pytest

from softfinger.tracking.disc import CONTRAST, LEVEL, SLOPE_X, SLOPE_Y
from softfinger.tracking.flat import (
    INSIDE,
    OUTSIDE,
    SUMS,
    add_pixels_array,
    add_products_array,
    compute_even_light,
    measure_rest_array,
)

P = np.array([20.3, 11.6, -60.0, 5.0, 0.7, 140.0, 0.004, -0.007])
SEGMENTS = [(8, 14, 19), (9, 22, 23), (13, 17, 26), (14, 30, 30)]


@pytest.fixture
def picture(rng):
    return rng.integers(60, 150, (24, 37, 2)).astype(np.uint8)


@pytest.fixture
def weight():
    return np.array([0.7, 0.4])


def write_out(picture, weight, place):
    """Derivatives and residual (9, pixel) of the segments' pixels."""
    rows = []
    for row, first, end in SEGMENTS:
        for column in range(first, end):
            dx, dy = column - P[0], row - P[1]
            shade = 1.0 + P[SLOPE_X] * dx + P[SLOPE_Y] * dy
            even = P[LEVEL] + (P[CONTRAST] if place == INSIDE else 0.0)
            light = picture[row, column] @ weight
            inside = shade if place == INSIDE else 0.0
            slopes = [shade, even * dx, even * dy, light - shade * even]
            rows.append([0.0, 0.0, inside, 0.0, 0.0, *slopes])
    return np.array(rows).T


def sum_up(picture, weight, place):
    sums = np.zeros(len(SUMS))
    even = compute_even_light(P, place)
    for row, first, end in SEGMENTS:
        add_pixels_array(picture, weight, row, first, end, P[0], P[1], even, sums)
    return sums


@pytest.mark.parametrize("place", [OUTSIDE, INSIDE])
def test_products_are_those_of_the_pixels(picture, weight, place):
    rows, products = write_out(picture, weight, place), np.zeros((9, 9))
    add_products_array(sum_up(picture, weight, place), P, place, products)
    np.testing.assert_allclose(products, np.tril(rows @ rows.T), rtol=1e-11, atol=1e-8)


@pytest.mark.parametrize("place", [OUTSIDE, INSIDE])
def test_what_a_step_leaves_is_that_of_the_pixels(picture, weight, place, rng):
    rows, step = write_out(picture, weight, place), rng.normal(size=8) * 0.1
    left = rows[8] - step @ rows[:8]
    found = measure_rest_array(sum_up(picture, weight, place), P, place, step, np.empty((9, 9)))
    assert found == pytest.approx(left @ left, rel=1e-10)
