"""Videos of real cameras, tracked by the verb, beside hand labels and another tool's output.

The campaigns state what a user knows: dots by colour and size, or by a click in the first picture.
"""

import shutil

import cv2
import numpy as np
import pandas as pd
import pytest

from softfinger.artifacts import open_artifact
from softfinger.artifacts.specs.markers import SPEC
from softfinger.campaign import read_campaign
from softfinger.cli import recordings
from softfinger.measurement.flags import MISSING
from softfinger.tracking.dots import measure_motion

SPECIMEN = """\
version: 1
name: dots
source: measured
specimen:
  motion: {quantity: distance, unit: pixel}
  load: {quantity: unknown, unit: "1"}
camera:
"""


def track(folder, camera, video):
    """Markers of a campaign with one video, by `softfinger track`."""
    (folder / "campaign.yaml").write_text(SPECIMEN + camera)
    (folder / "trials.csv").write_text(f"trial,video\none,{video}\n")
    recordings.track(folder, folder / "out")
    return open_artifact(folder / "out/markers/0000.nc", SPEC)


def compute_pendulum_angles(pivot, upper, lower):
    """Angles of the upper link against straight down, and of the lower against the upper."""
    first = np.arctan2(upper[:, 0] - pivot[0], upper[:, 1] - pivot[1])
    second = np.arctan2(lower[:, 0] - upper[:, 0], lower[:, 1] - upper[:, 1])
    return np.stack([first, second - first])


def wrap(angle):
    return np.angle(np.exp(1j * angle))


@pytest.fixture
def pendulum(realdata, tmp_path):
    """Markers of the two coloured dots in a hundred pictures, and the times of the pictures."""
    paths = sorted(
        (realdata / "dp-dots-handlabelled/frames").glob("*.jpg"),
        key=lambda path: float(path.stem.split("_")[1]),
    )
    film = cv2.VideoWriter(
        str(tmp_path / "film.avi"), cv2.VideoWriter.fourcc(*"FFV1"), 1.0, (1000, 1000)
    )
    for path in paths:
        film.write(cv2.imread(str(path)))
    film.release()
    camera = (
        "  fps: 1.0\n  dots:\n"
        '    red: {colour: "#7d2e1a", diameter_px: 50}\n'
        '    green: {colour: "#2c5a30", diameter_px: 50}\n'
    )
    return track(tmp_path, camera, "film.avi"), [float(p.stem.split("_")[1]) for p in paths]


def test_coloured_dots_are_found_in_every_picture_as_well_as_by_the_other_tool(pendulum, realdata):
    markers, times = pendulum
    folder = realdata / "dp-dots-handlabelled"
    labels = pd.read_csv(folder / "GroundTruthV1.csv", sep=";").set_index("Time")
    peer = pd.read_csv(folder / "EvalOutput.csv", sep=";")
    found = markers["marker_position"].sel(trial="one", marker=["red", "green"]).to_numpy()
    assert found.shape == (100, 2, 2)
    assert np.isfinite(found).all()
    hand = labels.loc[times, ["B_x", "B_y", "C_x", "C_y"]].to_numpy().reshape(-1, 2, 2)
    pivot = np.array([500.0, 500.0])
    common = (found - hand).mean(axis=(0, 1))  # labels are whole pixels
    by_hand = compute_pendulum_angles(pivot, *np.moveaxis(hand, 1, 0))
    errors = {}
    for name, places in (("as found", found), ("common offset removed", found - common)):
        angles = compute_pendulum_angles(pivot, *np.moveaxis(places, 1, 0))
        errors[name] = np.abs(wrap(angles - by_hand))
    print({name: error.mean(axis=1).round(5).tolist() for name, error in errors.items()}, common)
    others = peer[["abs_err_Angle1", "abs_err_Angle2"]].mean().to_numpy()
    assert (errors["common offset removed"].mean(axis=1) <= others).all()
    assert (errors["as found"].mean(axis=1) < 0.005).all()


@pytest.fixture
def balloon(realdata, tmp_path):
    """Markers of four clicked dots on a balloon, of which the last one is hardly there."""
    shutil.copy(realdata / "balloon-dots-video/Deflation_video.mp4", tmp_path / "film.mp4")
    camera = (
        "  fps: 29.896\n  dots:\n"
        "    left: {at_px: [49, 368], diameter_px: 56}\n"
        "    top: {at_px: [212, 338], diameter_px: 66}\n"
        "    low: {at_px: [222, 538], diameter_px: 56}\n"
        "    faint: {at_px: [350, 350], diameter_px: 60}\n"
    )
    return track(tmp_path, camera, "film.mp4"), tmp_path


def test_dots_that_shrink_fourfold_are_followed_and_a_faint_one_is_flagged(balloon, realdata):
    markers, folder = balloon
    one = markers.sel(trial="one")
    peer = pd.read_csv(realdata / "balloon-dots-video/tracked_points.csv")
    peer = peer.set_index(["frame", "point_id"])[["x", "y"]].to_numpy().reshape(-1, 4, 2)
    found = one["marker_position"].sel(marker=["left", "top", "low"]).to_numpy()
    assert len(found) == 288
    assert np.isfinite(found).all()
    off = np.hypot(*np.moveaxis(found - peer[:, [0, 1, 3]], -1, 0))
    print("off the other tool's track [px], median and largest:", np.median(off), off.max())
    assert np.median(off) < 2.5
    assert off.max() < 8.0
    # The faint dot must be flagged, and not be invented.
    assert ((one["marker_flag"].sel(marker="faint") & MISSING) > 0).all()
    distance = pd.read_csv(realdata / "balloon-dots-video/distance.csv")["L_pixels"].to_numpy()
    moved = measure_motion(one, read_campaign(folder))["joint_angle"].values[0]
    assert np.abs(moved - distance).max() < 8.0
