import numpy as np
import pytest

from softfinger.tracking.identity import match_finger_array


def name(rig, discs, tolerance=2.0):
    camera = rig.camera
    return match_finger_array(
        discs, camera.markers, rig.link_length, camera.metres_per_pixel, tolerance
    )


@pytest.mark.parametrize("angles", [(0.0, 0.0), (0.4, -0.3), (1.5, 1.9), (-2.0, 0.7)])
def test_shuffled_discs_get_their_names_back(rig, angles):
    places = rig.place(angles)
    order = rig.rng.permutation(len(places))
    match = name(rig, places[order])[0]
    np.testing.assert_array_equal(order[list(match.disc)], np.arange(len(places)))
    assert match.error < 1e-9


def test_more_blobs_than_markers_do_not_confuse(rig):
    places = rig.place((0.6, 0.5))
    decoys = rig.rng.uniform((0, 0), (220, 150), (12, 2))
    match = name(rig, np.concatenate([decoys, places]))[0]
    assert list(match.disc) == list(range(12, 12 + len(places)))


def test_places_that_were_glued_half_a_millimetre_off_are_found(rig):
    places = rig.place((0.2, 0.3)) + rig.rng.normal(0.0, 0.5, (7, 2))
    match = name(rig, places, tolerance=2.5)[0]
    assert list(match.disc) == list(range(7))
    assert 0.1 < match.error < 1.5


def test_a_finger_with_a_marker_missing_is_not_named(rig):
    assert name(rig, rig.place((0.2, 0.3))[[0, 1, 2, 4, 5, 6]]) == []
    assert name(rig, np.empty((0, 2))) == []
