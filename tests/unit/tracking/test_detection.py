import numpy as np
import pytest
from benchmarks._discs import draw_disc, expose

from softfinger.tracking.appearance import choose_weight, draw_closeness, measure_light
from softfinger.tracking.detection import find_discs_array
from softfinger.tracking.disc import CONTRAST, LEVEL

SHAPE = (120, 171)
CENTRES = np.array([[30.3, 40.7], [88.8, 77.1], [140.2, 25.5]])


def draw(level, contrast, radius=6.0):
    return level + contrast * sum(draw_disc(SHAPE, tuple(c), radius, 0.8, 8) for c in CENTRES)


def match(discs):
    gap = np.hypot(*(discs[:, None, :2] - CENTRES[None]).transpose(2, 0, 1))
    return gap.min(axis=0)


@pytest.mark.parametrize("sign", [-1, 1])
def test_every_disc_is_found_in_light_that_falls_to_a_quarter(sign, rng):
    even = draw(120.0, sign * 90.0)
    shade = np.linspace(1.0, 0.25, SHAPE[1])[None] * np.linspace(1.0, 0.7, SHAPE[0])[:, None]
    picture = expose(even * shade, 2.0, rng)[:, :, None]
    for polarity in (sign, 0):
        discs = find_discs_array(picture, np.ones(1), 6.0, polarity)
        assert len(discs) == 3
        assert match(discs).max() < 0.1
    assert len(find_discs_array(picture, np.ones(1), 6.0, -sign)) == 0


def test_noise_alone_holds_no_disc(rng):
    picture = expose(np.full(SHAPE, 120.0), 6.0, rng)[:, :, None]
    assert len(find_discs_array(picture, np.ones(1), 6.0, 0)) == 0


def test_a_square_and_a_wrong_size_are_no_marker_but_a_disc_beside_them_is(rng):
    light = draw(180.0, -100.0)
    light[90:112, 20:60] -= 100.0
    light -= 100.0 * draw_disc(SHAPE, (150.0, 90.0), 13.0, 0.8, 8)
    discs = find_discs_array(expose(light, 2.0, rng)[:, :, None], np.ones(1), 6.0, -1)
    assert len(discs) == 3
    assert match(discs).max() < 0.1


def test_a_declared_colour_tells_red_from_green(rng):
    red, green = np.array([40.0, 50.0, 190.0]), np.array([60.0, 150.0, 50.0])
    white = np.array([215.0, 220.0, 210.0])
    picture = np.broadcast_to(white, (*SHAPE, 3)).copy()
    for centre, colour in zip(CENTRES, (red, green, green), strict=True):
        disc = draw_disc(SHAPE, tuple(centre), 6.0, 0.8, 8)[..., None]
        picture = picture * (1 - disc) + disc * colour
    picture = expose(picture, 2.0, rng)
    found = find_discs_array(draw_closeness(picture, "#be3228"), np.ones(1), 6.0, 1)
    assert len(found) == 1
    assert match(found)[0] < 0.2
    assert len(find_discs_array(draw_closeness(picture, "#32963c"), np.ones(1), 6.0, 1)) == 2


def test_the_mix_of_channels_follows_contrast_and_noise(rng):
    disc = sum(draw_disc(SHAPE, tuple(c), 6.0, 0.8, 8) for c in CENTRES)[..., None]
    light = 100.0 + disc * np.array([60.0, 0.0, 60.0])
    noisy = light + rng.normal(size=light.shape) * np.array([2.0, 2.0, 12.0])
    picture = np.clip(np.rint(noisy), 0, 255).astype(np.uint8)
    rough = np.zeros((3, 8))
    rough[:, :2], rough[:, 3], rough[:, 4] = CENTRES, 6.0, 0.8
    known = measure_light(picture, np.array([1.0, 0.0, 0.0]), rough)
    np.testing.assert_allclose(known[:, CONTRAST], 60.0, atol=1.5)
    np.testing.assert_allclose(known[:, LEVEL], 100.0, atol=1.0)
    weight = choose_weight(picture, known)
    assert weight[0] > 5 * weight[2] > 0
    assert abs(weight[1]) < 0.1 * weight[0]
    np.testing.assert_allclose(np.abs(weight).sum(), 1.0)
    np.testing.assert_allclose(choose_weight(picture[:, :, :1], known), [1.0])


def test_a_grey_picture_in_three_channels_is_not_split_against_itself(rng):
    grey = expose(draw(160.0, -90.0), 3.0, rng)
    rough = np.zeros((3, 8))
    rough[:, :2], rough[:, 3], rough[:, 4] = CENTRES, 6.0, 0.8
    picture = np.repeat(grey[:, :, None], 3, axis=2)
    known = measure_light(picture, np.full(3, 1 / 3), rough)
    np.testing.assert_allclose(choose_weight(picture, known), 1 / 3, atol=1e-6)
