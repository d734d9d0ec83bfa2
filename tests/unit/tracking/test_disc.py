import numpy as np
import pytest
from benchmarks._discs import draw_disc
from scipy.ndimage import gaussian_filter

from softfinger.tracking.disc import compute_response_array, count_divisions


def draw_model(shape, centre, radius, spread):
    divisions = count_divisions(spread)
    return np.array(
        [
            [
                compute_response_array(j - centre[0], i - centre[1], radius, spread, divisions)[0]
                for j in range(shape[1])
            ]
            for i in range(shape[0])
        ]
    )


@pytest.mark.parametrize("blur", [0.15, 0.35, 0.6, 1.2])
def test_the_profile_is_that_of_a_disc_drawn_by_counting_sub_pixels(blur):
    centre, radius = (11.3, 9.8), 6.5
    drawn = draw_disc((20, 23), centre, radius, blur, 50)
    # Blur draws a curved edge inwards, by about S²/2R: a change of the radius, not of the shape.
    spread = np.hypot(blur, 12**-0.5)
    radii = radius - spread**2 / radius * np.linspace(0.0, 1.0, 21)
    off = [np.abs(draw_model((20, 23), centre, r, spread) - drawn).max() for r in radii]
    assert min(off) < 3e-3


@pytest.mark.parametrize("offset", [(5.1, 1.2), (-3.0, 4.4), (0.4, -5.9)])
@pytest.mark.parametrize("divisions", [1, 4])
def test_derivatives_agree_with_differences(offset, divisions):
    dx, dy = offset
    at = np.array([0.0, 0.0, 5.4, 0.8])

    def share(p):
        return compute_response_array(dx - p[0], dy - p[1], p[2], p[3], divisions)[0]

    numeric = [(share(at + h) - share(at - h)) / 2e-4 for h in 1e-4 * np.eye(4)]
    found = compute_response_array(dx, dy, at[2], at[3], divisions)[1:]
    np.testing.assert_allclose(found, numeric, atol=6e-3)
    np.testing.assert_allclose(found[:3], numeric[:3], atol=2e-4)


def test_far_inside_is_one_and_far_outside_is_nothing():
    assert compute_response_array(0.0, 0.0, 9.0, 0.7, 1) == (1.0, 0.0, 0.0, 0.0, 0.0)
    assert compute_response_array(0.0, 30.0, 9.0, 0.7, 1) == (0.0, 0.0, 0.0, 0.0, 0.0)


def test_drawn_blur_is_that_of_a_gaussian_filter():
    sharp = draw_disc((31, 35), (17.0, 15.0), 7.0, 0.0, 41)
    blurred = draw_disc((31, 35), (17.0, 15.0), 7.0, 1.5, 41)
    np.testing.assert_allclose(blurred, gaussian_filter(sharp, 1.5), atol=0.012)
    assert sharp.max() == 1.0
    assert sharp.min() == 0.0
