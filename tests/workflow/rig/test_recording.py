"""A campaign is recorded from the simulated rig by the code that records from a real one."""

import json

import cv2
import numpy as np
import pytest
import xarray as xr

from softfinger.campaign import check_campaign, read_campaign, read_load
from softfinger.rig.finger import VirtualFinger, build_finger_config
from softfinger.rig.virtual_camera import CAMERA_AHEAD_S
from softfinger.virtual_rig.scene import compute_marker_position

FPS = 10.0
SEED = 11
KNOTS = [
    (np.array([0, 0.4, 0.4, 0.8]), np.array([8, 8, 3, 3.0])),
    (np.array([0, 1.0, 2.0]), np.array([0, 6, 6.0])),
]


@pytest.fixture(scope="module")
def campaign(complete):
    return read_campaign(complete)


def read_notes(folder, name):
    return json.loads((folder / f"recording/{name}.json").read_text())


def test_the_folder_is_a_campaign_in_which_nothing_is_set_aside(campaign, complete):
    assert check_campaign(complete) == {}
    assert campaign.source == "synthetic"
    assert [trial.name for trial in campaign.trials] == ["trial_001", "trial_002"]
    first, second = campaign.trials
    assert second.started_at > first.started_at
    assert first.covariates["humidity_pct"] == 41.5
    assert 20.0 < first.covariates["temperature_c"] < 26.0
    assert not list(complete.rglob(".unfinished-*"))
    assert cv2.imread(str(complete / "preview.jpg")).shape == (480, 640, 3)


def test_the_load_is_the_profile_as_it_was_measured(campaign):
    for trial, knots in zip(campaign.trials, KNOTS, strict=True):
        time, tension = np.loadtxt(trial.load, delimiter=",", skiprows=1, unpack=True)
        since = time - time[0]
        assert 0.3 - 1 / FPS <= time[0] <= 0.3  # the lead-in, from the first frame within it
        assert since[-1] == pytest.approx(knots[0][-1], abs=0.011)
        calm = np.abs(since - 0.4) > 0.02
        expected = np.interp(since, *knots)
        np.testing.assert_allclose(tension[calm], expected[calm], atol=0.08)
        assert read_load(campaign, trial, 1 / FPS, 0.0)[2] == "tension_n"


def test_the_clocks_are_aligned_within_the_reported_uncertainty(complete):
    for name in ("trial_001", "trial_002"):
        notes = read_notes(complete, name)
        error = notes["camera_minus_controller_s"] - CAMERA_AHEAD_S
        assert abs(error) <= notes["camera_minus_controller_uncertainty_s"] + 1e-6
        assert abs(notes["clock_drift_s"]) <= notes["clock_drift_uncertainty_s"]
        assert notes["camera_minus_controller_uncertainty_s"] < 0.1 / FPS
        assert notes["frames_lost"] == 0


@pytest.mark.parametrize(("index", "knots"), list(enumerate(KNOTS)))
def test_each_frame_shows_the_finger_at_its_time(campaign, complete, index, knots):
    """The tip's mark is where the equations of motion put it, so video and load share time 0."""
    config = build_finger_config()
    finger = VirtualFinger(config, SEED)

    def compute_tip(since):
        angle = finger.compute_angle(index, *knots, since)
        marks = compute_marker_position(xr.DataArray(angle, dims="joint"), config)
        return marks.sel(marker="link_3_2").values

    trial = campaign.trials[index]
    uncertain = read_notes(complete, trial.name)["camera_minus_controller_uncertainty_s"]
    start = np.loadtxt(trial.load, delimiter=",", skiprows=1)[0, 0]
    capture = cv2.VideoCapture(str(trial.recording))
    number = 0
    while (read := capture.read())[0]:
        since = number / FPS - start
        number += 1
        early, tip, late = (compute_tip(since + off) for off in (-uncertain, 0.0, uncertain))
        if np.min(np.abs(since - knots[0])) > 0.02:  # not while it jumps
            allowed = 0.7 + np.abs(late - early).max()
            np.testing.assert_allclose(find_mark(read[1][:, :, 0], tip), tip, atol=allowed)
    assert number == pytest.approx((0.3 + knots[0][-1]) * FPS, abs=1)


def find_mark(frame, near, reach=12):
    """Centre of the dark pixels around a place."""
    row, column = np.mgrid[: frame.shape[0], : frame.shape[1]]
    around = np.hypot(column - near[0], row - near[1]) < reach
    dark = around & (frame < 130)
    return np.array([column[dark].mean(), row[dark].mean()])


def test_an_interrupted_campaign_goes_on_and_a_finished_one_stays(
    rig, plan_file, half_done, complete, read_files
):
    before = read_files(half_done)
    rig.record(plan_file, half_done)
    after = read_files(half_done)
    assert {name: after[name] for name in before if name != "trials.csv"} == {
        name: text for name, text in before.items() if name != "trials.csv"
    }
    assert after["trials.csv"].startswith(before["trials.csv"])
    assert [t.name for t in read_campaign(half_done).trials] == ["trial_001", "trial_002"]
    assert check_campaign(half_done) == {}
    since = len(rig.read_transcript())
    rig.record(plan_file, half_done)
    assert read_files(half_done) == after
    assert not any(" arm " in line for line in rig.read_transcript()[since:])
