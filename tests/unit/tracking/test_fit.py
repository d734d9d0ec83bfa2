import numpy as np
import pytest
from benchmarks._discs import compute_position_bound, draw_disc, expose

from softfinger.tracking.disc import CONTRAST, LEVEL, RADIUS, SPREAD, X, Y
from softfinger.tracking.fit import (
    FIT_QUALITY,
    LARGEST_WINDOW,
    MISFIT,
    NOISE_VARIANCE,
    UNIT_XX,
    fit_disc_array,
)
from softfinger.tracking.flat import SUMS
from softfinger.tracking.normal import invert_symmetric_array

SHAPE = (34, 41)


def fit(picture, start, others=None, own=-1, iterations=30, weight=None):
    p, quality = np.array(start, float), np.empty(len(FIT_QUALITY))
    picture = np.atleast_3d(picture)
    others = np.empty((0, 3)) if others is None else others
    rows, flat = np.empty((9, LARGEST_WINDOW)), np.empty((2, len(SUMS)))
    weight = np.ones(picture.shape[2]) if weight is None else weight
    good = fit_disc_array(picture, weight, p, 4.0, others, own, quality, rows, flat, iterations)
    return good, p, quality


@pytest.mark.parametrize(("level", "contrast"), [(180.0, -120.0), (30.0, 190.0)])
def test_every_parameter_of_a_noiseless_disc_is_found(level, contrast):
    light = level + contrast * draw_disc(SHAPE, (19.37, 16.81), 6.0, 0.7, 40)
    good, p, _ = fit(light, [18.6, 17.5, 0.6 * contrast, 5.2, 1.2, 0.9 * level, 0, 0])
    assert good
    np.testing.assert_allclose(p[[X, Y]], [19.37, 16.81], atol=1e-3)
    np.testing.assert_allclose(p[[CONTRAST, LEVEL]], [contrast, level], rtol=2e-3)
    np.testing.assert_allclose(p[RADIUS], 6.0 - 0.5 * (0.7**2 + 1 / 12) / 6.0, atol=0.01)
    np.testing.assert_allclose(p[SPREAD], np.hypot(0.7, 12**-0.5), atol=0.02)


def test_shade_on_disc_and_background_does_not_move_the_centre():
    even = 180.0 - 120.0 * draw_disc(SHAPE, (20.2, 16.4), 7.0, 0.6, 40)
    columns = np.arange(SHAPE[1])
    light = even * (1.0 + 0.015 * (columns - 20.2))
    good, p, _ = fit(light, [20, 16, -100, 7, 0.7, 170, 0, 0])
    assert good
    np.testing.assert_allclose(p[[X, Y]], [20.2, 16.4], atol=1e-3)
    np.testing.assert_allclose(p[6], 0.015, rtol=0.02)


def test_noise_is_that_of_the_light_beside_the_rim(rng):
    light = 180.0 - 120.0 * draw_disc(SHAPE, (20.2, 16.4), 7.0, 0.6)
    found = [fit(expose(light, 4.0, rng), [20, 16, -120, 7, 0.7, 180, 0, 0])[2] for _ in range(60)]
    expected = 4.0**2 + 1.0 / 12.0
    np.testing.assert_allclose(np.mean([q[NOISE_VARIANCE] for q in found]), expected, rtol=0.03)
    np.testing.assert_allclose(np.mean([q[MISFIT] for q in found]), 1.0, atol=0.05)


def test_claimed_variance_is_near_the_bound():
    light = 180.0 - 120.0 * draw_disc(SHAPE, (20.2, 16.4), 6.0, 0.6, 40)
    _, _, quality = fit(light, [20, 16, -120, 6, 0.7, 180, 0, 0])
    bound = compute_position_bound((20.2, 16.4), 6.0, 0.6, -120.0, 3.0)
    claimed = np.sqrt(quality[UNIT_XX] * (3.0**2 + 1.0 / 12.0))
    assert 1.0 <= claimed / bound < 1.1


def test_pixels_of_a_neighbour_are_left_out():
    own, other = (15.0, 17.0), (27.5, 17.0)
    light = 180.0 - 120.0 * (draw_disc(SHAPE, own, 5.0, 0.6) + draw_disc(SHAPE, other, 5.0, 0.6))
    start = [15.3, 16.8, -120, 5, 0.7, 180, 0, 0]
    others = np.array([[*own, 6.5], [*other, 6.5]])
    _, guarded, _ = fit(light, start, others, 0)
    _, alone, _ = fit(light, start)
    np.testing.assert_allclose(guarded[[X, Y]], own, atol=2e-3)
    assert abs(alone[X] - own[0]) > 5e-3


def test_a_blank_picture_has_no_disc(rng):
    blank = expose(np.full(SHAPE, 120.0), 3.0, rng)
    good, _, quality = fit(blank, [20, 16, -5, 6, 0.7, 120, 0, 0])
    certain = good and quality[UNIT_XX] * quality[NOISE_VARIANCE] < (0.15 * 6.0) ** 2
    assert not certain


def test_a_disc_half_out_of_the_picture_is_still_placed():
    light = 180.0 - 120.0 * draw_disc(SHAPE, (1.4, 16.4), 6.0, 0.6, 40)
    good, p, _ = fit(light, [1.0, 16, -120, 6, 0.7, 180, 0, 0])
    assert good
    np.testing.assert_allclose(p[[X, Y]], [1.4, 16.4], atol=0.01)


def test_a_window_outside_the_picture_fails():
    assert not fit(np.full(SHAPE, 100.0), [90, 16, -120, 6, 0.7, 180, 0, 0])[0]


def test_light_is_a_mix_of_channels():
    disc = draw_disc(SHAPE, (20.2, 16.4), 6.0, 0.6, 30)
    picture = np.stack([100.0 + 0 * disc, 60.0 + 80.0 * disc, 150.0 - 90.0 * disc], axis=2)
    good, p, _ = fit(picture, [20, 16, 80, 6, 0.7, -40, 0, 0], weight=np.array([0.0, 0.5, -0.5]))
    assert good
    np.testing.assert_allclose(p[[X, Y]], [20.2, 16.4], atol=1e-3)
    np.testing.assert_allclose(p[CONTRAST], 85.0, rtol=1e-3)


def test_the_inverse_is_an_inverse_and_a_singular_matrix_is_refused(rng):
    rows = rng.normal(size=(6, 9))
    matrix = rows @ rows.T
    low, inverse = np.empty((6, 6)), np.empty((6, 6))
    assert invert_symmetric_array(np.tril(matrix), low, inverse)
    np.testing.assert_allclose(inverse @ matrix, np.eye(6), atol=1e-9)
    assert not invert_symmetric_array(np.ones((6, 6)), low, inverse)
