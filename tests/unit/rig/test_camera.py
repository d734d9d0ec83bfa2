import time

import cv2
import numpy as np
import pytest
import xarray as xr

from softfinger.faults import Fault
from softfinger.rig.camera import FrameGrabber, OpenCvCamera, open_camera
from softfinger.rig.finger import VirtualFinger, build_finger_config
from softfinger.rig.plan import Plan
from softfinger.rig.video import write_video
from softfinger.rig.virtual_camera import SYNC_LIGHT_PX, ExposureFeed, VirtualCamera
from softfinger.settings import read_settings
from softfinger.virtual_rig.scene import compute_marker_position


def take_until(grabber, count):
    """Frames as they come; the grabber's own timeout ends the wait."""
    frames = []
    while len(frames) < count:
        frames += grabber.take()
        time.sleep(0.002)
    return frames


def write_film(path, n):
    pictures = [np.full((60, 80), 20 * k, np.uint8) for k in range(n)]
    write_video(path, [cv2.imencode(".jpg", p)[1].tobytes() for p in pictures], 25.0)
    return path


def test_opencv_gives_every_frame_and_says_when_there_are_no_more(tmp_path):
    camera = OpenCvCamera(str(write_film(tmp_path / "a.avi", 5)), 25.0, 80, 60)
    frames = [camera.read() for _ in range(5)]
    assert np.all(np.diff([stamp for stamp, _ in frames]) > 0)
    np.testing.assert_allclose([p.mean() for _, p in frames], 20 * np.arange(5), atol=1.5)
    with pytest.raises(Fault, match="sends no picture any more"):
        camera.read()
    camera.close()


def test_a_camera_that_is_not_there_is_a_fault(plan, tmp_path):
    for name in (str(tmp_path / "absent.avi"), "virtual:1"):
        with pytest.raises(Fault, match=r"camera .*(cannot be opened|no simulator answers)"):
            open_camera(name, plan)


def test_the_grabber_hands_out_frames_and_then_the_cameras_fault(tmp_path, plan_values):
    plan_values["recording"] |= {"picture_px": [80, 60], "sync_light_px": [10, 20, 8, 4]}
    plan = read_settings(Plan, plan_values, "plan")
    film = write_film(tmp_path / "a.avi", 5)
    with FrameGrabber(open_camera(str(film), plan), plan) as grabber:
        frames = take_until(grabber, 5)
        with pytest.raises(Fault, match="no picture any more"):
            take_until(grabber, 1)
    assert [round(f.brightness / 20) for f in frames] == [0, 1, 2, 3, 4]
    assert cv2.imdecode(np.frombuffer(frames[0].jpeg, np.uint8), 0).shape == (60, 80)


def test_a_camera_that_takes_another_size_is_a_fault(tmp_path, plan):
    film = write_film(tmp_path / "a.avi", 5)
    with (
        FrameGrabber(open_camera(str(film), plan), plan) as grabber,
        pytest.raises(Fault, match=r"pictures of 80 × 60 px, but .*picture_px is \[640, 480"),
    ):
        take_until(grabber, 1)


def test_a_silent_camera_is_a_fault(plan_values):
    plan_values["safety"]["camera_timeout_s"] = 0.1
    plan = read_settings(Plan, plan_values, "plan")
    feed = ExposureFeed(30.0)
    with (
        FrameGrabber(open_camera(feed.name, plan), plan) as grabber,
        pytest.raises(Fault, match=r"no picture"),
    ):
        take_until(grabber, 1)
    feed.close()


def test_the_virtual_camera_films_the_finger_and_the_light():
    feed = ExposureFeed(20.0)
    camera = VirtualCamera(int(feed.name.partition(":")[2]), 5.0)
    feed.list_due_frames(0.0)
    assert list(feed.list_due_frames(0.11)) == [1, 2]
    angle = np.array([0.4, 0.3, 0.2])
    feed.send(1, False, angle)
    feed.send(2, True, angle)
    (first, dark), (second, lit) = camera.read(), camera.read()
    assert second - first == pytest.approx(0.05)
    x, y, width, height = SYNC_LIGHT_PX
    place = np.s_[y : y + height, x : x + width]
    assert lit[place].mean() - dark[place].mean() > 50
    marks = compute_marker_position(xr.DataArray(angle, dims="joint"), build_finger_config()).values
    for column, row in marks.round().astype(int):
        assert dark[row, column] < 100 < dark[0, 0]
    feed.hang_up()
    with pytest.raises(Fault, match="is gone"):
        camera.read()
    camera.close()
    feed.close()


def test_the_finger_is_where_the_history_of_its_load_puts_it():
    finger = VirtualFinger(build_finger_config(), seed=4)
    pulled = (np.array([5.0]), np.array([8.0]))
    released = (np.array([5.0, 6.0, 6.0]), np.array([8.0, 8.0, 0.0]))
    rest = finger.compute_angle(0, *pulled, 4.0)
    at_six = finger.compute_angle(0, *pulled, 6.0)
    assert np.all(at_six > rest + 0.1)
    np.testing.assert_allclose(finger.compute_angle(0, *released, 6.0), at_six, atol=1e-6)
    later = finger.compute_angle(0, *released, 8.0)
    assert np.all((later > rest) & (later < at_six))  # the creep stays
    assert np.all(finger.compute_angle(1, *pulled, 4.0) != rest)
