import numpy as np
import pytest
from scipy.ndimage import gaussian_filter

from softfinger.virtual_rig.config import read_config
from softfinger.virtual_rig.render import (
    BACKGROUND_GREY,
    BODY_GREY,
    PROFILE_STEPS_PER_PX,
    build_canvas,
    build_light,
    build_noise_table,
    compute_disc_profile,
    draw_finger,
    expose_array,
)

SHAPE = (480, 640)
NO_CAPSULES, NO_MARKS = np.empty((0, 5)), np.empty((0, 2))
LONG_BAR = np.array([[100.0, 200.0, 500.0, 200.0, 60.0]])


@pytest.fixture
def even_canvas(config):
    return build_canvas(read_config(config | {"light_unevenness": 0.0}), NO_CAPSULES)


def draw(canvas, capsules, marks):
    picture = canvas.still.copy()
    draw_finger(picture, canvas, capsules, marks)
    return picture


def test_disc_profile_equals_a_finely_sampled_convolution():
    fine = 20
    row, column = np.mgrid[-200:201, -200:201] / fine
    disc = np.clip((5.0 - np.hypot(row, column)) * fine + 0.5, 0, 1)
    blurred = gaussian_filter(disc, 0.8 * fine, truncate=8)
    profile = compute_disc_profile(5.0, 0.8)
    radius = np.arange(0, 8.5, 0.5)
    expected = np.interp(radius * PROFILE_STEPS_PER_PX, np.arange(profile.size), profile)
    np.testing.assert_allclose(blurred[200, 200 + (radius * fine).astype(int)], expected, atol=3e-4)


def test_a_disc_is_as_large_as_it_is_declared(even_canvas):
    """The missing light is contrast × π R², whatever the blur."""
    dark = draw(even_canvas, LONG_BAR, NO_MARKS) - draw(
        even_canvas, LONG_BAR, np.array([[250.3, 210.7]])
    )
    radius = 0.004 / 0.000235 / 2
    assert dark.sum(dtype=float) / 130.0 == pytest.approx(np.pi * radius**2, rel=1e-4)


def test_marks_are_dark_on_a_light_body_on_a_grey_ground(even_canvas):
    picture = draw(even_canvas, LONG_BAR, np.array([[250.0, 210.0]]))
    assert picture[210, 250] == pytest.approx(BODY_GREY - 130.0)
    assert picture[210, 300] == pytest.approx(BODY_GREY)
    assert picture[10, 20] == pytest.approx(BACKGROUND_GREY)
    assert picture[140, 300] == pytest.approx((BODY_GREY + BACKGROUND_GREY) / 2, abs=0.01)


def test_light_dims_body_ground_and_marks_alike(config):
    even = build_canvas(read_config(config | {"light_unevenness": 0.0}), LONG_BAR)
    uneven = build_canvas(read_config(config | {"light_unevenness": 0.3}), LONG_BAR)
    marks = np.array([[120.0, 200.0], [480.0, 210.0]])
    light = build_light(0.3)
    assert light.shape == SHAPE
    assert light.max() == 1
    assert light.min() == pytest.approx(0.7)
    np.testing.assert_allclose(
        draw(uneven, NO_CAPSULES, marks), light * draw(even, NO_CAPSULES, marks), rtol=1e-5
    )


def test_parts_outside_the_picture_are_cut_off(even_canvas):
    capsules = np.array([[-50.0, 100.0, 60.0, -40.0, 20.0], [700.0, 500.0, 900.0, 600.0, 20.0]])
    marks = np.array([[0.0, 200.0], [639.0, 479.0], [-100.0, 50.0], [9000.0, 50.0]])
    picture = draw(even_canvas, capsules, marks)
    assert picture[200, 0] == pytest.approx(BODY_GREY - 130.0)
    assert picture[479, 639] == pytest.approx(BODY_GREY - 130.0)
    assert picture[100, 300] == pytest.approx(BACKGROUND_GREY)


def expose(picture, noise_sd, key):
    frame = np.empty(picture.shape, np.uint8)
    expose_array(picture, build_noise_table(noise_sd), np.uint64(key), frame)
    return frame


def test_noise_has_the_declared_sd_and_the_shape_of_a_normal():
    picture = np.full(SHAPE, 120.25, np.float32)
    error = expose(picture, 3.0, 77) - 120.25
    n = error.size
    assert error.mean() == pytest.approx(0.0, abs=4 * 3 / np.sqrt(n))
    assert error.var() == pytest.approx(9 + 1 / 12, rel=4 * np.sqrt(2 / n))  # 1/12: rounding
    # The table's tails end at 3.7 sd, which takes 0.01 from a fourth moment of 3
    assert ((error / error.std()) ** 4).mean() == pytest.approx(3.0, abs=4 * np.sqrt(24 / n) + 0.01)
    assert (error**3).mean() / 27 == pytest.approx(0.0, abs=4 * np.sqrt(6 / n))


def test_noise_is_independent_between_pixels_and_frames():
    picture = np.full(SHAPE, 120.0, np.float32)
    error = expose(picture, 3.0, 77).astype(float) - 120
    other = expose(picture, 3.0, 78).astype(float) - 120
    spectrum = abs(np.fft.rfft2(error, norm="ortho")[1:-1, 1:-1]) ** 2 / error.var()
    assert spectrum.mean() == pytest.approx(1.0, abs=0.01)
    assert spectrum.max() < 25  # the largest of 1.5e5 exponential variates is near 12
    for lag in [*range(1, 9), 640, 641]:
        product = error.ravel()[lag:] * error.ravel()[:-lag]
        assert product.mean() / error.var() == pytest.approx(0.0, abs=4.5 / np.sqrt(error.size))
    assert (error * other).mean() / error.var() == pytest.approx(0, abs=4 / np.sqrt(error.size))


def test_exposure_rounds_and_saturates():
    picture = np.array([[-4.0, 0.4, 0.6, 254.4], [254.6, 300.0, 10.0, 9.5001]], np.float32)
    expected = [[0, 0, 1, 254], [255, 255, 10, 10]]
    np.testing.assert_array_equal(expose(picture, 0.0, 5), expected)


def test_noise_comes_from_splitmix64():
    """The published generator's first output for seed 0, cut to the top 8 bits of its 4 lanes."""
    first_output = 0xE220A8397B1DCDAF
    frame = np.empty((1, 4), np.uint8)
    whole_levels = np.arange(4096, dtype=np.float32) // 16
    expose_array(np.zeros((1, 4), np.float32), whole_levels, np.uint64(0x9E3779B97F4A7C15), frame)
    np.testing.assert_array_equal(frame[0], [0xCD, 0x7B, 0xA8, 0xE2])
    assert [first_output >> shift & 0xFF for shift in (8, 24, 40, 56)] == list(frame[0])
