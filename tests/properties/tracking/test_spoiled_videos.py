"""Whatever a video file holds: a sentence, or angles that are right, flagged or missing.

Motion JPEG keeps damage within its frame, and a lone wrong frame is for the fit's rule of outliers.
FFV1 as OpenCV writes it has neither checksums nor frames that stand alone: what is damaged shows a
clean picture of an earlier moment, and nothing can tell. There the angles need only be valid.
"""

import os
import shutil
import sys
from pathlib import Path

import numpy as np
import pytest

os.environ.setdefault("OPENCV_FFMPEG_LOGLEVEL", "-8")
import cv2
from benchmarks._discs import draw_disc, expose

from softfinger.artifacts.spec import list_faults
from softfinger.artifacts.specs.angles import SPEC as ANGLES
from softfinger.artifacts.specs.markers import SPEC as MARKERS
from softfinger.campaign import read_campaign
from softfinger.faults import Fault
from softfinger.tracking import assemble_angles, track_trials

sys.path.insert(0, str(Path(__file__).parents[1]))
from damage import spoil_file

FRAMES, FPS = 40, 30.0
ROWS, COLUMNS = 150, 220
SCALE = 0.0005  # m/px
FARTHEST = 0.05  # rad: ten times what coding and noise leave
CAMPAIGN = """\
version: 1
name: films
source: synthetic
finger: {joints: 2, link_length_m: [0.030, 0.028], wire_offset_m: 0.005}
camera:
  fps: 30.0
  metres_per_pixel: 0.0005
  marker_diameter_m: 0.004
  marker_colour: dark
  markers: {base: [-0.022, -0.009], link_1: [0.007, 0.022], link_2: [0.006, 0.023]}
"""
PLACES = ((-44, -18), (14, 44), (12, 46))  # px
LINKS = (60, 56)


def bend(time):
    """True joint angles (joint, time) [rad]."""
    grown = 1.0 - np.exp(-time / 0.2) + 0.1 * time
    return np.array([0.4 * grown, 0.6 * grown])


def draw(angles, rng):
    joint, heading = np.array([60.0, 100.0]), 0.0
    light = np.full((ROWS, COLUMNS), 180.0)
    for number, places in enumerate(PLACES):
        heading += angles[number - 1] if number else 0.0
        along = np.array([np.cos(heading), -np.sin(heading)])
        for place in places:
            light -= 120.0 * draw_disc((ROWS, COLUMNS), joint + place * along, 4.0, 0.6, 8)
        joint = joint + (LINKS[number - 1] * along if number else 0.0)
    return expose(light, 2.0, rng)


def write_campaign(folder, name, codec):
    (folder / "video").mkdir(parents=True)
    (folder / "campaign.yaml").write_text(CAMPAIGN)
    (folder / "trials.csv").write_text(f"trial,video,load\none,video/{name},load.csv\n")
    (folder / "load.csv").write_text("time_s,tension_n\n0.0,6.0\n1.2,6.0\n")
    code, rng = cv2.VideoWriter.fourcc(*codec), np.random.default_rng(8)
    writer = cv2.VideoWriter(
        str(folder / "video" / name), cv2.CAP_FFMPEG, code, FPS, (COLUMNS, ROWS), False
    )
    for angles in bend(np.arange(FRAMES) / FPS).T:
        writer.write(draw(angles, rng))
    writer.release()
    return folder


@pytest.fixture(scope="module")
def films(tmp_path_factory) -> list[Path]:
    """One film coded with losses, one without."""
    folder = tmp_path_factory.mktemp("films")
    kinds = {"a": ("trial.avi", "MJPG"), "b": ("trial.mkv", "FFV1")}
    return [write_campaign(folder / key, *kind) for key, kind in kinds.items()]


def judge(folder) -> str:
    """'refused' or 'used': what is used and not flagged is near the truth."""
    campaign = read_campaign(folder)
    try:
        markers = track_trials(campaign, ["one"])
        assert list_faults(MARKERS, markers) == []
        angles = assemble_angles(campaign, [markers])
    except Fault:
        return "refused"
    assert list_faults(ANGLES, angles) == []
    time, angle = angles["time"].to_numpy()[0], angles["joint_angle"].to_numpy()[0]
    assert (np.diff(time) > 0).all()
    used = angles["angle_flag"].to_numpy()[0] == 0
    assert np.isfinite(angle[used]).all()
    if campaign.trials[0].recording.suffix == ".avi":
        wrong = (np.abs(angle - bend(time)) > FARTHEST) & used
        assert wrong.any(axis=0).sum() <= 1, f"{wrong.sum()} wrong angles"
    return "used"


def spoil_many(films, tmp_path, seeds) -> set[str]:
    verdicts = set()
    for seed in seeds:
        source = films[seed % 2]
        (video,) = (source / "video").iterdir()
        folder = tmp_path / str(seed)
        (folder / "video").mkdir(parents=True)
        for name in ("campaign.yaml", "trials.csv", "load.csv"):
            shutil.copy(source / name, folder)
        done = spoil_file(video, folder / "video" / video.name, np.random.default_rng(seed))
        try:
            verdicts.add(judge(folder))
        except Exception as error:
            error.add_note(f"seed {seed}: {done} of {video.name}")
            raise
        (folder / "video" / video.name).unlink()
    return verdicts


def test_whole_films_are_used(films):
    assert [judge(folder) for folder in films] == ["used", "used"]


def test_spoiled_films_give_sentences_or_right_angles(films, tmp_path):
    assert spoil_many(films, tmp_path, range(60)) == {"refused", "used"}


@pytest.mark.slow
def test_a_thousand_spoiled_films_give_sentences_or_right_angles(films, tmp_path):
    spoil_many(films, tmp_path, range(1000, 2000))
