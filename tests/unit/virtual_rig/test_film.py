import hashlib

import cv2
import numpy as np
import pytest

from softfinger.virtual_rig.config import read_config
from softfinger.virtual_rig.film import film_trial, open_video, render_frames
from softfinger.virtual_rig.scene import compute_marker_position


def read_video(path):
    capture = cv2.VideoCapture(str(path))
    capture.set(cv2.CAP_PROP_CONVERT_RGB, 0)
    frames = []
    while (read := capture.read())[0]:
        frames.append(read[1].reshape(480, 640))
    return np.array(frames), capture.get(cv2.CAP_PROP_FPS)


def compute_centroid(frame, place, reach=13):
    """Darkness-weighted mean place within a round window, background by the window's rim."""
    row, column = np.mgrid[: frame.shape[0], : frame.shape[1]]
    distance = np.hypot(column - place[0], row - place[1])
    ground = np.median(frame[(distance > 11) & (distance < reach)])
    dark = np.where(distance < 11.5, ground - frame.astype(float), 0.0)
    return np.array([(dark * column).sum(), (dark * row).sum()]) / dark.sum()


def test_marks_in_the_frames_are_where_the_truth_is(truth, config):
    """Without noise and under even light the centroid is off by less than 0.01 px."""
    quiet = read_config(config | {"camera_noise_grey": 0.0, "light_unevenness": 0.0})
    angle = truth.joint_angle.isel(trial=2)
    position = compute_marker_position(angle, quiet).values
    for frame, marks in zip(render_frames(angle, quiet, 1, 2), position, strict=True):
        for mark in marks:
            np.testing.assert_allclose(compute_centroid(frame, mark), mark, atol=0.01)


def test_compression_leaves_the_marks_where_they_are(truth, config, tmp_path):
    config = config | {"light_unevenness": 0.0}
    film_trial(truth, config, 1, tmp_path / "a.avi", seed=3)
    frames, _ = read_video(tmp_path / "a.avi")
    rig = read_config(config)
    angle = truth.joint_angle.isel(trial=1)
    position = compute_marker_position(angle, rig).values
    shift = [
        compute_centroid(seen, mark) - compute_centroid(raw, mark)
        for seen, raw, marks in zip(frames, render_frames(angle, rig, 3, 1), position, strict=True)
        for mark in marks
    ]
    assert np.mean(shift) == pytest.approx(0.0, abs=0.003)
    assert np.std(shift) < 0.015


def test_a_video_has_the_declared_rate_and_every_frame(truth, config, tmp_path):
    film_trial(truth, config, 0, tmp_path / "video" / "a.avi", seed=3)
    frames, fps = read_video(tmp_path / "video" / "a.avi")
    assert fps == pytest.approx(10.0, rel=1e-6)
    assert frames.shape == (7, 480, 640)


def test_same_seed_same_bytes(truth, config, tmp_path):
    digests = []
    for name, trial, seed in [("a", 0, 3), ("b", 0, 3), ("c", 0, 4), ("d", 1, 3)]:
        film_trial(truth, config, trial, tmp_path / f"{name}.avi", seed)
        digests.append(hashlib.sha256((tmp_path / f"{name}.avi").read_bytes()).hexdigest())
    assert digests[0] == digests[1]
    assert len(set(digests)) == 3


def test_noise_differs_between_frames_and_trials_of_a_still_finger(truth, config):
    rig = read_config(config)
    still = truth.joint_angle.isel(trial=0).isel(frame=[0, 0])
    first, second = (frame.astype(int) for frame in map(np.copy, render_frames(still, rig, 3, 0)))
    other = next(render_frames(still, rig, 3, 1)).astype(int)
    for difference in (second - first, other - first):
        assert difference.var() == pytest.approx(2 * (9 + 1 / 12), rel=0.02)


def test_an_interrupted_video_leaves_nothing_and_spares_the_old_one(tmp_path):
    def interrupt():
        with open_video(path, 30.0, 90) as write:
            write(np.zeros((480, 640), np.uint8))
            raise KeyboardInterrupt

    path = tmp_path / "a.avi"
    path.write_bytes(b"old")
    with pytest.raises(KeyboardInterrupt):
        interrupt()
    assert [entry.name for entry in tmp_path.iterdir()] == ["a.avi"]
    assert path.read_bytes() == b"old"
