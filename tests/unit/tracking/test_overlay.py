import cv2
import numpy as np
import pytest

from softfinger.measurement.flags import JUMP, MISSING
from softfinger.tracking.overlay import (
    choose_worst_frames,
    draw_contact_sheet,
    draw_overlay,
    write_overlay,
)
from softfinger.tracking.track import track_video


@pytest.fixture
def film(rig):
    return rig.film([rig.draw(rig.place((0.05 * k, 0.03 * k))) for k in range(12)])


@pytest.fixture
def markers(rig, film):
    found = track_video(film, rig.camera, rig.link_length)
    found["marker_position"][7, 4] = np.nan
    found["marker_flag"][7, 4] = MISSING
    found["marker_flag"][3, 5] = JUMP
    found["marker_position_sd"][9, 0] = 3.0
    return found


def test_the_worst_frames_are_those_that_miss_then_those_in_doubt(markers):
    np.testing.assert_array_equal(choose_worst_frames(markers, 1), [7])
    np.testing.assert_array_equal(choose_worst_frames(markers, 2), [3, 7])
    np.testing.assert_array_equal(choose_worst_frames(markers, 3), [3, 7, 9])
    assert len(choose_worst_frames(markers, 99)) == 12


def test_rings_stand_on_the_markers_and_red_ones_are_suspect(rig, markers):
    picture = rig.draw(rig.place((0.15, 0.09)))
    canvas = draw_overlay(picture, markers, 3)
    assert canvas.shape == (*picture.shape[:2], 3)
    x, y = np.round(markers["marker_position"][3, 5].to_numpy()).astype(int)
    near = canvas[y - 8 : y + 9, x - 8 : x + 9].reshape(-1, 3).astype(int)
    assert (near[:, 2] - near[:, 0] > 150).sum() > 20
    far = canvas[-30:, -30:].astype(int)
    assert np.ptp(far, axis=2).max() == 0


def test_a_sheet_holds_so_many_pictures(rig, film, markers):
    sheet = draw_contact_sheet(film, 30.0, markers, 4)
    assert sheet.shape == (2 * 150, 3 * 220, 3)
    assert (sheet[150:, 220:] == 255).all()


def test_an_overlay_has_every_frame(rig, film, markers, tmp_path):
    path = tmp_path / "overlay.avi"
    write_overlay(film, 30.0, markers, path)
    capture = cv2.VideoCapture(str(path))
    frames = []
    while True:
        read, frame = capture.read()
        if not read:
            break
        frames.append(frame)
    assert len(frames) == 12
    expected = draw_overlay(rig.draw(rig.place((0.0, 0.0)), noise=0.0), markers, 0)
    assert np.abs(frames[0].astype(int) - expected).mean() < 12
