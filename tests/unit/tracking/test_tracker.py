import numpy as np
import pytest

from softfinger.tracking.body import Body
from softfinger.tracking.disc import PARAMETERS
from softfinger.tracking.start import start_at_points
from softfinger.tracking.tracker import Tracker


def follow(tracker, pictures):
    return np.array([tracker.follow(picture)[0][:, :2] for picture in pictures])


def start(places, links, contrast=-120.0):
    known = np.zeros((len(places), len(PARAMETERS)))
    known[:, :2], known[:, 2:6] = places, [contrast, 4.0, 0.7, 180.0]
    return Tracker(np.ones(1), known, Body.measure(links, known[:, :2]), np.full(len(known), 4.0))


def test_a_fast_finger_is_followed(rig):
    angles = [(0.6 * (1 - np.exp(-k / 3)), 0.8 * (1 - np.exp(-k / 4))) for k in range(14)]
    truth = np.array([rig.place(a) for a in angles])
    assert np.abs(np.diff(truth, axis=0)).max() > 2.5 * 4.0  # more than a diameter in a frame
    tracker = start(truth[0], [[0, 1], [2, 3], [4, 5, 6]])
    found = follow(tracker, [rig.draw(places) for places in truth])
    assert np.abs(found - truth).max() < 0.08


def test_discs_that_pass_close_by_keep_their_names(rig):
    across = np.linspace(30, 190, 33)
    truth = np.stack(
        [
            np.stack([across, np.full(33, 60.0)], axis=1),
            np.stack([across[::-1], np.full(33, 70.5)], axis=1),
        ],
        axis=1,
    )
    found = follow(start(truth[0], [[0], [1]]), [rig.draw(places) for places in truth])
    assert np.abs(found - truth).max() < 0.15


def test_a_hidden_marker_is_missing_and_comes_back_under_its_name(rig):
    angles = [(0.02 * k, 0.03 * k) for k in range(16)]
    truth = np.array([rig.place(a) for a in angles])
    hidden = slice(4, 10)
    pictures = [
        rig.draw(np.delete(places, [2, 3], axis=0) if hidden.start <= k < hidden.stop else places)
        for k, places in enumerate(truth)
    ]
    found = follow(start(truth[0], [[0, 1], [2, 3], [4, 5, 6]]), pictures)
    assert np.isnan(found[hidden, 2:4]).all()
    others = np.delete(found, [2, 3], axis=1)
    assert np.abs(others - np.delete(truth, [2, 3], axis=1)).max() < 0.08
    assert np.abs(found[hidden.stop :] - truth[hidden.stop :]).max() < 0.08


def test_motion_blur_moves_the_centre_to_the_middle_of_the_exposure(rig):
    middle = np.array([[30.0 + 6.0 * k, 50.0 + 3.0 * k] for k in range(12)])
    exposure = np.linspace(-0.3, 0.3, 7)[:, None] * [6.0, 3.0]
    pictures = [
        np.mean([rig.draw([place + shift], noise=1.0) for shift in exposure], axis=0)
        for place in middle
    ]
    blurred = [np.rint(picture).astype(np.uint8) for picture in pictures]
    found = follow(start(middle[:1], [[0]]), blurred)[:, 0]
    assert np.abs(found - middle).max() < 0.03


def test_a_marker_that_fades_away_is_not_invented(rig):
    pictures = [rig.draw([(60.0, 70.0)], contrast=-120.0 * 0.5**k, noise=3.0) for k in range(14)]
    found = follow(start(np.array([[60.0, 70.0]]), [[0]]), pictures)
    assert np.isfinite(found[:3]).all()
    assert np.isnan(found[-4:]).all()


@pytest.mark.parametrize("shape", ["speckle", "edge"])
def test_nothing_but_texture_is_not_taken_for_a_lost_marker(rig, shape):
    first = rig.draw([(60.0, 70.0)])
    texture = rig.draw([], noise=12.0)
    if shape == "edge":
        texture[:, 62:] = 40
    tracker = start(np.array([[60.0, 70.0]]), [[0]])
    found = follow(tracker, [first, *[texture] * 5])
    assert np.isfinite(found[0]).all()
    assert np.isnan(found[1:]).all()


def test_without_geometry_it_starts_from_rough_places(rig):
    truth = np.array([[50.0, 40.0], [150.0, 100.0]])
    tracker = start_at_points(rig.draw(truth), truth + np.array([[1.5, -1.0], [-1.0, 1.2]]), 4.5)
    expected = truth + np.arange(5)[:, None, None] * np.array([0.5, 0.0])
    found = follow(tracker, [rig.draw(places) for places in expected])
    assert np.abs(found - expected).max() < 0.08
