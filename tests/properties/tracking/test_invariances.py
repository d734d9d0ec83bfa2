import numpy as np
from benchmarks._discs import draw_disc, expose
from hypothesis import given, settings
from hypothesis import strategies as st

from softfinger.tracking.angles import build_covariance_array, compute_direction_array, unwrap_array
from softfinger.tracking.fit import FIT_QUALITY, LARGEST_WINDOW, fit_disc_array
from softfinger.tracking.flat import SUMS
from softfinger.tracking.outliers import find_jumps_array

SHAPE = (36, 43)
START = np.array([20.0, 17.0, -110.0, 6.0, 0.8, 175.0, 0.0, 0.0])


def fit(light, start):
    p, quality = start.copy(), np.empty(len(FIT_QUALITY))
    rows, flat = np.empty((9, LARGEST_WINDOW)), np.empty((2, len(SUMS)))
    picture, others = np.atleast_3d(light), np.empty((0, 3))
    assert fit_disc_array(picture, np.ones(1), p, 2.5, others, -1, quality, rows, flat, 30)
    return p, quality


def draw(seed, x, y):
    light = 180.0 - 120.0 * draw_disc(SHAPE, (x, y), 6.2, 0.7, 12)
    return expose(light, 3.0, np.random.default_rng(seed))


phases = st.floats(-0.5, 0.5)


@settings(deadline=None, max_examples=25)
@given(st.integers(0, 999), phases, phases, st.integers(-3, 3), st.integers(-2, 2))
def test_a_picture_shifted_by_whole_pixels_shifts_the_place(seed, x, y, right, down):
    picture = draw(seed, 20.0 + x, 17.0 + y)
    shifted = np.roll(picture, (down, right), axis=(0, 1))
    offset = np.array([right, down, 0, 0, 0, 0, 0, 0])
    here, quality = fit(picture, START)
    there, other = fit(shifted, START + offset)
    np.testing.assert_allclose(there - offset, here, atol=1e-9)
    # variances are about 1e-5 px²; a covariance may be as good as 0
    np.testing.assert_allclose(other, quality, rtol=1e-9, atol=1e-14)


@settings(deadline=None, max_examples=25)
@given(st.integers(0, 999), phases, phases)
def test_a_picture_with_its_axes_swapped_swaps_the_coordinates(seed, x, y):
    picture = draw(seed, 20.0 + x, 17.0 + y)
    order = [1, 0, 2, 3, 4, 5, 7, 6]
    here, quality = fit(picture, START)
    swapped, other = fit(picture.T.copy(), START[order])
    np.testing.assert_allclose(swapped[order], here, atol=1e-8)
    np.testing.assert_allclose(other[[1, 0, 2, 3, 4]], quality, rtol=1e-6, atol=1e-12)


@settings(deadline=None, max_examples=25)
@given(st.integers(0, 999), st.floats(0.2, 5.0), st.floats(-50.0, 50.0))
def test_brighter_and_more_contrasty_pictures_give_the_same_place(seed, gain, lift):
    picture = draw(seed, 20.3, 16.8).astype(float)
    here, quality = fit(picture, START)
    # The shade is relative to the light, so only an even gain leaves the model the same.
    scale = np.array([1, 1, gain, 1, 1, gain, 1, 1])
    there, other = fit(gain * picture, START * scale)
    np.testing.assert_allclose(there, here * scale, rtol=1e-6, atol=1e-9)
    np.testing.assert_allclose(other[3], gain**2 * quality[3], rtol=1e-6)
    lifted, _ = fit(picture + lift, START + lift * np.eye(8)[5])
    np.testing.assert_allclose(lifted[:2], here[:2], atol=5e-3)


@settings(deadline=None)
@given(st.floats(-np.pi, np.pi), st.floats(0.1, 10.0), st.integers(0, 999))
def test_a_turned_link_turns_by_as_much_whatever_its_size(turn, scale, seed):
    rng = np.random.default_rng(seed)
    position = np.cumsum(rng.uniform(5.0, 10.0, (1, 3, 2)), axis=1)
    sd = rng.uniform(0.01, 0.1, (1, 3))
    matrix = np.array([[np.cos(turn), np.sin(turn)], [-np.sin(turn), np.cos(turn)]])
    direction, variance = compute_direction_array(position, sd)
    turned, same = compute_direction_array(scale * position @ matrix.T + 100.0, scale * sd)
    np.testing.assert_allclose(np.exp(1j * (turned - direction)), np.exp(1j * turn), atol=1e-9)
    np.testing.assert_allclose(same, variance, rtol=1e-9)


@settings(deadline=None)
@given(st.lists(st.floats(1e-8, 1.0), min_size=2, max_size=6))
def test_covariances_of_relative_angles_are_positive(variance):
    covariance = build_covariance_array(np.array([variance]))[0]
    np.testing.assert_array_equal(covariance, covariance.T)
    assert np.linalg.eigvalsh(covariance).min() > 0
    np.testing.assert_allclose(covariance.sum(), variance[0] + variance[-1], rtol=1e-6, atol=1e-12)


@settings(deadline=None)
@given(st.integers(0, 999), st.floats(-3.0, 3.0), st.floats(0.0, 0.3))
def test_unwrapping_gives_back_any_slow_turn(seed, start, speed):
    rng = np.random.default_rng(seed)
    angle = start + speed * np.arange(60) + 0.01 * rng.standard_normal(60)
    found = unwrap_array(np.angle(np.exp(1j * angle)))
    np.testing.assert_allclose(found - found[0], angle - angle[0], atol=1e-9)


@settings(deadline=None, max_examples=40)
@given(st.integers(0, 9999), st.floats(0.2, 6.0), st.floats(0.01, 2.0), st.floats(0.02, 3.0))
def test_no_ring_and_no_creep_is_taken_for_a_jump(seed, frequency, amplitude, decay):
    rng = np.random.default_rng(seed)
    time = np.arange(200) / 30.0
    after = np.maximum(time - 2.0, 0.0)
    swing = np.exp(-decay * after) * np.cos(2 * np.pi * frequency * after)
    value = amplitude * (1.0 - swing) * (time >= 2.0) + 0.02 * time
    noisy = value + 0.001 * rng.standard_normal(time.size)
    assert not find_jumps_array(time, noisy, np.array([2.0])).any()
