from types import SimpleNamespace

import numpy as np
import pytest
import xarray as xr

from softfinger.measurement.flags import JUMP, MISSING, STALE
from softfinger.tracking.angles import (
    compute_direction_array,
    compute_joint_angles,
    steady_base_array,
    unwrap_array,
)

NAMES = ["base_1", "base_2", "link_1_1", "link_1_2", "link_2_1", "link_2_2", "link_2_3"]


@pytest.fixture
def campaign(rig):
    return SimpleNamespace(finger=SimpleNamespace(bends_sign=1), camera=rig.camera)


def build(rig, angles, sd=0.05, noise=0.0, turn=0.0):
    """Markers of a finger that takes the given angles (frame, joint), the camera turned."""
    places = np.array([rig.place(a) for a in angles])
    places += noise * rig.rng.standard_normal(places.shape)
    rotation = np.array([[np.cos(turn), np.sin(turn)], [-np.sin(turn), np.cos(turn)]])
    places = (places - 100.0) @ rotation.T + 100.0
    return xr.Dataset(
        {
            "time": ("frame", np.arange(len(places)) / 30.0),
            "marker_position": (("frame", "marker", "axis"), places),
            "marker_position_sd": (("frame", "marker"), np.full(places.shape[:2], sd)),
        },
        coords={"marker": NAMES, "axis": ["x", "y"]},
    )


ANGLES = np.array([[0.0, 0.0], [0.3, -0.2], [0.9, 0.4], [1.8, 1.1]])


@pytest.mark.parametrize("turn", [0.0, 1.0, -2.8])
def test_angles_are_counter_clockwise_as_seen_however_the_camera_is_turned(rig, campaign, turn):
    found = compute_joint_angles(build(rig, ANGLES, turn=turn), campaign)
    np.testing.assert_allclose(found["joint_angle"].to_numpy(), ANGLES.T, atol=1e-12)
    assert (found["angle_flag"] == 0).all()


def test_a_finger_that_bends_clockwise_changes_the_sign(rig, campaign):
    campaign.finger.bends_sign = -1
    found = compute_joint_angles(build(rig, ANGLES), campaign)
    np.testing.assert_allclose(found["joint_angle"].to_numpy(), -ANGLES.T, atol=1e-12)


def test_bends_beyond_half_a_turn_do_not_wrap(rig, campaign):
    angles = np.linspace([0.0, 0.0], [4.5, 3.6], 80)
    found = compute_joint_angles(build(rig, angles), campaign)
    np.testing.assert_allclose(found["joint_angle"].to_numpy(), angles.T, atol=1e-9)


def test_claimed_covariance_is_that_of_many_noisy_frames(rig, campaign):
    frames = 4000
    markers = build(rig, np.tile([[0.4, 0.7]], (frames, 1)), sd=0.05, noise=0.05)
    found = compute_joint_angles(markers, campaign)
    actual = np.cov(found["joint_angle"].to_numpy())
    claimed = found["joint_angle_covariance"].to_numpy().mean(axis=0)
    np.testing.assert_allclose(claimed, actual, rtol=0.06)
    assert actual[0, 1] < 0


def test_the_average_of_the_base_is_as_sure_as_its_frames_allow(rig, campaign):
    frames = 400
    markers = build(rig, np.tile([[0.4, 0.7]], (frames, 1)), sd=0.05, noise=0.05)
    claimed = compute_joint_angles(markers, campaign)["joint_angle_covariance"].to_numpy()[0]
    base_gap = 26.0
    link = 0.05**2 * 2 / 30.0**2
    base = 0.05**2 * 2 / base_gap**2 * (1.0 / frames + 0.01)
    np.testing.assert_allclose(claimed[0, 0], link + base, rtol=0.06)


def test_a_base_that_moves_is_not_averaged():
    still = 0.2 + 0.001 * np.tile([1.0, -1.0, 0.5], 40)
    angle, variance = steady_base_array(still, np.full(120, 1e-6))
    assert np.ptp(angle) == 0.0
    np.testing.assert_allclose(variance, 1e-6 * (1 / 120 + 0.01))
    moving = still + np.linspace(0.0, 0.1, 120)
    angle, variance = steady_base_array(moving, np.full(120, 1e-6))
    np.testing.assert_array_equal(angle, moving)
    np.testing.assert_array_equal(variance, np.full(120, 1e-6))


def test_a_link_with_one_marker_seen_is_missing_and_one_of_three_lost_is_not(rig, campaign):
    markers = build(rig, ANGLES)
    markers["marker_position"][1, 3] = np.nan
    markers["marker_position"][2, 5] = np.nan
    found = compute_joint_angles(markers, campaign)
    angle = found["joint_angle"].to_numpy()
    np.testing.assert_array_equal(np.isnan(angle), [[False, True, False, False]] * 2)
    np.testing.assert_array_equal(found["angle_flag"] == MISSING, np.isnan(angle))
    np.testing.assert_allclose(angle[:, 2], ANGLES[2], atol=1e-12)
    worse = found["joint_angle_covariance"].to_numpy()[:, 1, 1]
    assert worse[2] > worse[3]


def test_flags_of_markers_reach_both_joints_of_a_link(rig, campaign):
    markers = build(rig, ANGLES)
    flag = np.zeros((4, 7), np.uint8)
    flag[1, 2], flag[2, 6], flag[3] = JUMP, JUMP, STALE
    found = compute_joint_angles(markers.assign(marker_flag=(("frame", "marker"), flag)), campaign)
    np.testing.assert_array_equal(
        found["angle_flag"], [[0, JUMP, 0, STALE], [0, JUMP, JUMP, STALE]]
    )


def test_where_no_sd_is_claimed_no_covariance_is(rig, campaign):
    found = compute_joint_angles(build(rig, ANGLES, sd=np.nan), campaign)
    np.testing.assert_allclose(found["joint_angle"].to_numpy(), ANGLES.T, atol=1e-12)
    assert np.isnan(found["joint_angle_covariance"]).all()


def test_a_batch_is_its_trials(rig, campaign):
    one, other = build(rig, ANGLES), build(rig, ANGLES[::-1])
    batch = xr.concat([one, other], dim=xr.DataArray(["a", "b"], dims="trial", name="trial"))
    found = compute_joint_angles(batch, campaign)
    assert found["joint_angle"].dims == ("trial", "joint", "frame")
    for k, alone in enumerate((one, other)):
        np.testing.assert_array_equal(
            found["joint_angle"][k], compute_joint_angles(alone, campaign)["joint_angle"]
        )


def test_markers_that_are_surer_weigh_more():
    position = np.array([[[0.0, 0.0], [10.0, 0.0], [20.0, 2.0]]])
    even, _ = compute_direction_array(position, np.full((1, 3), 0.1))
    doubted, _ = compute_direction_array(position, np.array([[0.1, 0.1, 100.0]]))
    assert abs(doubted[0]) < 1e-4 < abs(even[0])


def test_a_false_half_turn_does_not_shift_what_follows():
    angle = np.linspace(0.0, 4.0, 60)
    found = angle.copy()
    found[[20, 21]] += [3.0, -3.0]
    found[40:43] = np.nan
    wrapped = np.angle(np.exp(1j * found))
    whole = unwrap_array(wrapped)
    good = np.isfinite(found)
    good[[20, 21]] = False
    np.testing.assert_allclose(whole[good], angle[good], atol=1e-12)
    assert np.isnan(whole[40:43]).all()
