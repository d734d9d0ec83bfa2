import numpy as np
import pytest

from softfinger.faults import Fault
from softfinger.measurement.frames import select_frames


def test_a_frame_counts_when_every_present_joint_was_seen(campaign):
    angles, _, _ = campaign
    angles["joint_angle"][1, 0, 7] = np.nan
    angles["angle_flag"][2, 1, 9] = 2
    used = select_frames(angles)["used"].values
    expected = np.ones(used.shape, bool)
    expected[1, 7] = expected[2, 9] = False
    assert (used == expected).all()


def test_a_joint_that_was_hardly_seen_does_not_cost_the_others_their_frames(campaign):
    angles, _, _ = campaign
    angles["joint_angle"][3, 2, 20:] = np.nan
    frames = select_frames(angles)
    assert frames["present"].values[3].tolist() == [True, True, False]
    assert frames["used"].values[3].all()


def test_a_trial_without_frames_is_not_used(campaign):
    angles, _, _ = campaign
    angles["joint_angle"][4] = np.nan
    frames = select_frames(angles)
    assert not frames["used"].values[4].any()
    assert not frames["present"].values[4].any()
    assert frames["used"].values[:4].all()


def test_nothing_seen_is_a_fault(campaign):
    angles, _, _ = campaign
    with pytest.raises(Fault, match="no trial has 8 frames"):
        select_frames(angles.assign(angle_flag=angles["angle_flag"] + 1))


def test_repeated_times_count_once(campaign):
    angles, _, _ = campaign
    angles["time"][0, 5] = angles["time"][0, 4]
    used = select_frames(angles)["used"].values
    assert not used[0, 5]
    assert used.sum() == used.size - 1


def test_scale_is_the_claimed_sd_over_the_usual_one(campaign):
    angles, _, _ = campaign
    covariance = np.broadcast_to(np.diag([1.0, 4.0, 9.0]) * 1e-6, (5, 90, 3, 3)).copy()
    covariance[2, 11] *= 25
    dims = angles["joint_angle_covariance"].dims
    frames = select_frames(angles.assign(joint_angle_covariance=(dims, covariance)))
    scale = frames["frame_scale"].values
    assert scale[2, 11] == pytest.approx(5.0)
    assert np.delete(scale.ravel(), 2 * 90 + 11) == pytest.approx(1.0)


def test_interval_is_the_median_between_used_frames(campaign):
    angles, _, _ = campaign
    angles["joint_angle"][:, :, 1::2] = np.nan
    assert float(select_frames(angles)["frame_interval"]) == pytest.approx(2 / 30)


@pytest.mark.parametrize(("seen", "used"), [(7, False), (8, True)])
def test_a_trial_of_few_frames_is_not_used(campaign, seen, used):
    angles, _, _ = campaign
    angles["joint_angle"][4, :, seen:] = np.nan
    assert bool(select_frames(angles)["used"].values[4].any()) == used
