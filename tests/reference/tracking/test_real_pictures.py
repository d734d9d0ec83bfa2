"""Tracking on pictures of real cameras, beside hand labels and another tool's output."""

import cv2
import numpy as np
import pandas as pd

from softfinger.tracking.start import locate_discs, start_at_points
from softfinger.tracking.video import read_frames


def compute_pendulum_angles(pivot, upper, lower):
    """Angles of the upper link against straight down, and of the lower against the upper."""
    first = np.arctan2(upper[:, 0] - pivot[0], upper[:, 1] - pivot[1])
    second = np.arctan2(lower[:, 0] - upper[:, 0], lower[:, 1] - upper[:, 1])
    return np.stack([first, second - first])


def wrap(angle):
    return np.angle(np.exp(1j * angle))


def test_coloured_dots_are_found_in_every_frame_as_well_as_by_the_other_tool(realdata):
    folder = realdata / "dp-dots-handlabelled"
    labels = pd.read_csv(folder / "GroundTruthV1.csv", sep=";").set_index("Time")
    peer = pd.read_csv(folder / "EvalOutput.csv", sep=";")
    found, times = [], []
    for path in sorted((folder / "frames").glob("*.jpg")):
        picture = cv2.imread(str(path))
        dots = [locate_discs(picture, 25.0, colour) for colour in ("#7d2e1a", "#2c5a30")]
        assert [len(discs) for discs in dots] == [1, 1], path.name
        found.append([discs[0, :2] for discs in dots])
        times.append(float(path.stem.split("_")[1]))
    found = np.array(found)
    assert len(found) == 100
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


def test_dots_that_shrink_fourfold_are_followed_by_hand_held_phone(realdata):
    folder = realdata / "balloon-dots-video"
    peer = pd.read_csv(folder / "tracked_points.csv").set_index(["frame", "point_id"])[["x", "y"]]
    peer = peer.to_numpy().reshape(-1, 4, 2)
    tracker, found = None, []
    for frame in read_frames(folder / "Deflation_video.mp4", 29.896):
        tracker = tracker or start_at_points(frame.picture, peer[0], 28.0)
        found.append(tracker.follow(frame.picture)[0])
    found = np.array(found)
    assert len(found) == 288
    dots = [0, 1, 3]
    assert np.isfinite(found[:, dots, 0]).all()
    off = np.hypot(*np.moveaxis(found[:, dots, :2] - peer[:, dots], -1, 0))
    assert np.median(off) < 2.5
    assert off.max() < 8.0
    assert (found[0, dots, 3] / found[-1, dots, 3] > 2.5).all()
    # The other tool's point 2 was never on its faint dot: it must not be invented.
    assert np.isnan(found[:, 2, 0]).all()
