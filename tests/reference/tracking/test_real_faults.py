"""Faults of other people's trackers, found by general rules."""

import numpy as np
import pandas as pd

from softfinger.campaign import read_campaign
from softfinger.measurement.flags import JUMP, STALE
from softfinger.tracking import assemble_angles
from softfinger.tracking.outliers import find_jumps_array

DOCUMENTED_JUMPS = {"pwm080_old4": 12, "pwm080_old5": 17, "pwm080_old6": 6, "pwm040_old0": 2}


def test_the_jumps_of_a_soft_finger_are_masked_and_its_ring_is_not(realdata):
    angles = assemble_angles(read_campaign(realdata / "softfinger-a"), [])
    assert angles.sizes["trial"] == 43
    jumps = (angles["angle_flag"].to_numpy()[:, 0] & JUMP) > 0
    found = dict(zip(angles["trial"].values, jumps.sum(axis=1), strict=True))
    assert {name: count for name, count in found.items() if count} == DOCUMENTED_JUMPS
    # About -65 degrees, where no finger was.
    assert angles["joint_angle"].to_numpy()[:, 0][jumps].max() < -1.0


def test_frames_of_a_camera_slower_than_its_log_are_stale(realdata):
    angles = assemble_angles(read_campaign(realdata / "softfinger-a"), [])
    frames = np.isfinite(angles["time"]).sum("frame").to_numpy()
    stale = ((angles["angle_flag"].to_numpy()[:, 0] & STALE) > 0).sum(axis=1)
    distinct = frames - stale
    assert (distinct > 100).all()
    assert (distinct < 185).all()


def test_rounded_rheometer_readings_are_not_repeated_frames(realdata):
    for name in ("polystyrene-130", "polystyrene-190"):
        angles = assemble_angles(read_campaign(realdata / name), [])
        flag = angles["angle_flag"].to_numpy()
        assert not (flag & (STALE | JUMP)).any()


def test_swaps_and_false_blobs_of_a_marker_table_are_found(realdata):
    table = pd.read_csv(realdata / "tdcr-tendon-staircase/RawDataT1T2_flat.csv")
    # Rows in which a marker stands on the false blob, or under the other one's name.
    left = {1: [*range(29, 44), 236, 238, 239, 241, 242, *range(244, 250)]}
    left[2] = left[1][15:]
    right = [53, 54, 275, *range(283, 295)]
    documented = {
        "T1_L": left,
        "T1_R": {1: [], 2: []},
        "T2_L": {1: [53, 54], 2: [53, 54]},
        "T2_R": {1: right, 2: right},
    }
    hits = said = true = 0
    for camera, markers in documented.items():
        for marker, rows in markers.items():
            path = table[[f"{camera}x{marker}", f"{camera}y{marker}"]].dropna().to_numpy(float)
            flagged = find_jumps_array(0.2 * np.arange(len(path)), path, np.array([]))
            found = set(np.flatnonzero(flagged).tolist())
            hits += len(found & set(rows))
            said += len(found)
            true += len(rows)
    print(f"recall {hits / true:.3f}, precision {hits / said:.3f}, {true} faulty places")
    assert hits / true >= 0.98
    assert hits / said >= 0.98
