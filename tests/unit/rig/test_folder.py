import dataclasses
import json
from datetime import UTC, datetime

import cv2
import numpy as np
import pytest

from softfinger.campaign import check_campaign, read_campaign
from softfinger.faults import Fault
from softfinger.rig.clocks import ClockOffset
from softfinger.rig.folder import open_folder
from softfinger.rig.plan import build_schedule
from softfinger.rig.trial import TrialRecording

NOON = datetime(2026, 5, 4, 12, 0, 0, 250_000, tzinfo=UTC)


@pytest.fixture
def recording() -> TrialRecording:
    """Seven frames, eleven samples; the pull begins at the fourth and ends at the tenth."""
    pictures = [
        cv2.imencode(".jpg", np.full((48, 64), 30 * k, np.uint8))[1].tobytes() for k in range(7)
    ]
    tension = np.where(np.arange(11) < 3, -0.01, 8.0)
    tension[5] = -0.004
    return TrialRecording(
        started=12.0,
        sample_time=0.02 * np.arange(11),
        tension=tension,
        current=0.05 * tension,
        load_start=0.06,
        load_end=0.18,
        stamp=np.array([5.0, 5.03, np.nan, 5.1, 5.13, 5.17, 5.2]),
        pictures=pictures,
        rate=29.97,
        jitter=0.0,
        before=ClockOffset(3.0, 0.001),
        after=ClockOffset(3.002, 0.001),
    )


def begin(path, plan, text="a plan", simulated=True):
    return open_folder(path, plan, text, simulated)


def test_what_is_written_is_a_campaign(tmp_path, plan, recording):
    folder = begin(tmp_path / "c", plan)
    first, second = build_schedule(plan)[:2]
    folder.add(first, recording, NOON, {"temperature_c": 23.25})
    folder.add(second, recording, NOON, {"humidity_pct": 40.0})
    assert check_campaign(folder.path) == {}
    campaign = read_campaign(folder.path)
    assert campaign.source == "synthetic"
    assert [t.name for t in campaign.trials] == ["trial_001", "trial_002"]
    assert campaign.trials[0].started_at == NOON
    assert campaign.trials[0].covariates["temperature_c"] == 23.25
    assert np.isnan(campaign.trials[1].covariates["temperature_c"])
    notes = json.loads((folder.path / "recording/trial_001.json").read_text())
    assert notes["frames_lost"] == 1
    assert notes["clock_drift_s"] == pytest.approx(0.002)


def test_the_load_begins_with_the_pull_and_never_pushes(tmp_path, plan, recording):
    folder = begin(tmp_path / "c", plan)
    folder.add(build_schedule(plan)[0], recording, NOON, {})
    time, tension = np.loadtxt(
        folder.path / "load/trial_001.csv", delimiter=",", skiprows=1, unpack=True
    )
    assert time[0] == 0.06
    assert tension.tolist() == [8.0, 8.0, 0.0, 8.0, 8.0, 8.0, 8.0]


def test_the_video_holds_every_picture_at_the_measured_rate(tmp_path, plan, recording):
    folder = begin(tmp_path / "c", plan)
    folder.add(build_schedule(plan)[0], recording, NOON, {})
    capture = cv2.VideoCapture(str(folder.path / "video/trial_001.avi"))
    assert capture.get(cv2.CAP_PROP_FPS) == pytest.approx(29.97, rel=1e-5)
    grey = []
    while (read := capture.read())[0]:
        grey.append(read[1].mean())
    np.testing.assert_allclose(grey, 30 * np.arange(7), atol=1.5)


def test_colour_stays_colour(tmp_path, plan, recording):
    red = np.zeros((48, 64, 3), np.uint8)
    red[:, :, 2] = 200
    jpeg = cv2.imencode(".jpg", red)[1].tobytes()
    folder = begin(tmp_path / "c", plan)
    coloured = dataclasses.replace(recording, pictures=[jpeg] * 7)
    folder.add(build_schedule(plan)[0], coloured, NOON, {})
    _, picture = cv2.VideoCapture(str(folder.path / "video/trial_001.avi")).read()
    np.testing.assert_allclose(picture[24, 32], [0, 0, 200], atol=6)


def test_going_on_keeps_what_is_finished_and_clears_what_is_not(tmp_path, plan, recording):
    first = build_schedule(plan)[0]
    begin(tmp_path / "c", plan).add(first, recording, NOON, {})
    (tmp_path / "c/video/.unfinished-trial_002.avi").write_bytes(b"half")
    before = {p.name: p.read_bytes() for p in (tmp_path / "c").rglob("*.*")}
    again = begin(tmp_path / "c", plan)
    assert again.finished == ["trial_001"]
    after = {p.name: p.read_bytes() for p in (tmp_path / "c").rglob("*.*")}
    assert after == {k: v for k, v in before.items() if "unfinished" not in k}


@pytest.mark.parametrize(
    ("prepare", "changes", "said"),
    [
        (True, {"text": "another plan"}, "begun with another plan"),
        (True, {"simulated": False}, "source is 'synthetic', this rig's 'measured'"),
        (False, {}, "no recording of this program"),
    ],
)
def test_a_folder_of_something_else_is_not_touched(tmp_path, plan, prepare, changes, said):
    if prepare:
        begin(tmp_path, plan)
    else:
        (tmp_path / "notes.txt").write_text("mine")
    before = sorted(tmp_path.rglob("*"))
    with pytest.raises(Fault, match=said):
        begin(tmp_path, plan, **changes)
    assert sorted(tmp_path.rglob("*")) == before


def test_a_trial_is_not_begun_that_the_disk_could_not_hold(tmp_path, plan):
    folder = begin(tmp_path / "c", plan)
    folder.require_space(1000)
    with pytest.raises(Fault, match=r"MB are free on this disk, but the next trial needs"):
        folder.require_space(10**18)


def test_a_file_that_cannot_be_written_leaves_the_table_as_it_was(tmp_path, plan, recording):
    first, second = build_schedule(plan)[:2]
    folder = begin(tmp_path / "c", plan)
    folder.add(first, recording, NOON, {})
    table = (folder.path / "trials.csv").read_bytes()
    (folder.path / "load/trial_002.csv").mkdir()
    with pytest.raises(Fault, match=r"trial_002.csv: it cannot be written"):
        folder.add(second, recording, NOON, {})
    assert (folder.path / "trials.csv").read_bytes() == table
    assert folder.finished == ["trial_001"]
    assert not list(folder.path.rglob(".unfinished-*"))


def test_a_folder_that_was_hardly_begun_is_begun_again(tmp_path, plan):
    begin(tmp_path / "c", plan)
    whole = sorted(tmp_path.rglob("*"))
    (tmp_path / "c/campaign.yaml").unlink()
    begin(tmp_path / "c", plan)
    assert sorted(tmp_path.rglob("*")) == whole
    (tmp_path / "c/campaign.yaml").unlink()
    (tmp_path / "c/recording/plan.yaml").rename(tmp_path / "c/recording/.unfinished-plan.yaml")
    begin(tmp_path / "c", plan)
    assert sorted(tmp_path.rglob("*")) == whole
