"""The optics against pictures of two markers a link, distorted one by one."""

import numpy as np
import pytest

from softfinger.mechanics.forward.simulate import describe_finger, simulate_joint_angle_array
from softfinger.mechanics.forward.slots import build_slots
from softfinger.mechanics.geometry import FingerGeometry

LENGTH, CENTRE = np.array([0.025, 0.02]), np.array([0.03, 0.02])
FINGER = describe_finger(
    FingerGeometry.uniform(LENGTH, [0.005, 0.004], 0.008, 0.005), optical_centre=CENTRE
)
PARAMETERS = np.array([[[-2.4, -3.7, 2.9, 0.03], [-1.9, -3.9, 3.3, 0.01]]])
TIME, LOAD = np.linspace(0.0, 8.0, 15), ([0.0, 4.0, 4.0], [0.04, 0.04, 0.02])
APART_M = 1e-4  # short lines of markers: their turn is that of the picture where they are


def look(**slots):
    return simulate_joint_angle_array(
        PARAMETERS, build_slots(1, 2, slots), [], FINGER, TIME, *LOAD, tolerance=1e-10
    )[0][0]


def see(angle, distort):
    """Angles (joint, frame) that a distorted picture of markers in pairs shows."""
    direction = np.vstack([np.zeros(angle.shape[1]), np.cumsum(angle, axis=0)])
    along = np.stack([np.cos(direction), np.sin(direction)], axis=-1)
    begin = np.zeros_like(along)
    begin[2:] = np.cumsum(LENGTH[:-1, None, None] * along[1:-1], axis=0)
    middle = np.array([-LENGTH[0] / 2, *LENGTH / 2])[:, None, None]
    ends = [begin + (middle + side * APART_M) * along - CENTRE for side in (-1.0, 1.0)]
    line = np.subtract(*(distort(end) for end in ends[::-1]))
    return np.diff(np.unwrap(np.arctan2(line[..., 1], line[..., 0]), axis=1), axis=0)


@pytest.mark.parametrize("slant", [(2.0, 0.0), (0.0, 2.0), (2.0, -1.0)])
def test_a_picture_plane_aslant_is_a_perspective(slant):
    seen = see(look(), lambda place: place / (1.0 + place @ np.array(slant))[..., None])
    by = look(slant_along=slant[0], slant_across=slant[1]) - look()
    assert np.abs(by).max() > 2e-3
    np.testing.assert_allclose(by, seen - look(), rtol=1e-4, atol=1e-8)


def test_a_plane_aslant_has_its_own_optical_centre():
    slant, shift = np.array([2.0, -1.0]), np.array([0.01, -0.015])

    def distort(place):
        return (place - shift) / (1.0 + (place - shift) @ slant)[..., None]

    about = look(slant_along=2.0, slant_across=-1.0, lens_along=0.01, lens_across=-0.015)
    by = about - look(slant_along=2.0, slant_across=-1.0)
    assert np.abs(by).max() > 2e-3
    np.testing.assert_allclose(about, see(look(), distort), rtol=1e-4, atol=1e-8)


def test_a_lens_moves_places_radially():
    seen = see(look(), lambda place: place * (1.0 + 10.0 * (place**2).sum(axis=-1, keepdims=True)))
    by = look(lens_radial=10.0) - look()
    assert np.abs(by).max() > 2e-3
    np.testing.assert_allclose(by, seen - look(), rtol=1e-4, atol=1e-8)


def test_a_lens_of_fifth_order_moves_places_radially():
    def distort(place):
        return place * (1.0 + 5000.0 * (place**2).sum(axis=-1, keepdims=True) ** 2)

    by = look(lens_fifth=5000.0) - look()
    assert np.abs(by).max() > 2e-3
    np.testing.assert_allclose(by, see(look(), distort) - look(), rtol=1e-4, atol=1e-8)


@pytest.mark.parametrize("beside", [(1.0, 0.0), (0.0, 1.0), (1.0, -0.5)])
def test_lenses_beside_each_other_decentre_the_picture(beside):
    def distort(place):
        square = (place**2).sum(axis=-1, keepdims=True)
        shift = np.array(beside)
        return place + shift * square + 2.0 * place * (place @ shift)[..., None]

    by = look(decentring_along=beside[0], decentring_across=beside[1]) - look()
    assert np.abs(by).max() > 2e-3
    np.testing.assert_allclose(by, see(look(), distort) - look(), rtol=1e-4, atol=1e-8)


def test_a_lens_off_its_centre_is_decentred_to_first_order():
    shifted = look(lens_radial=10.0, lens_along=1e-5, lens_across=-2e-5) - look(lens_radial=10.0)
    beside = look(lens_radial=10.0, decentring_along=-1e-4, decentring_across=2e-4)
    np.testing.assert_allclose(beside - look(lens_radial=10.0), shifted, rtol=1e-2, atol=1e-10)
