import numpy as np
import pytest
import xarray as xr

from softfinger.faults import CampaignFault
from softfinger.tracking.sense import find_sense, refuse_wrong_sign

TIME = np.arange(120) * 0.05


def build(angle, load_time, load):
    joints = np.stack([0.6 * angle, 0.4 * angle])
    return xr.Dataset(
        {
            "time": ("frame", TIME),
            "joint_angle": (("joint", "frame"), joints),
            "angle_flag": (("joint", "frame"), np.zeros(joints.shape, np.uint8)),
            "load_time": ("knot", np.array(load_time, float)),
            "load_torque": ("knot", np.array(load, float)),
        }
    )


CREEP = 0.3 * (1.0 - np.exp(-TIME))
ON_AND_OFF = ([0.0, 1.0, 1.0, 4.0, 4.0], [0.0, 0.0, 2.0, 2.0, 0.0])


@pytest.mark.parametrize("sign", [1, -1])
@pytest.mark.parametrize("pull", [1, -1])
def test_the_sense_is_that_of_motion_and_load_together(sign, pull, rng):
    noise = 0.002 * rng.standard_normal(TIME.size)
    held = build(sign * pull * CREEP + noise, [0.0, 0.0, 6.0], [0.0, pull, pull])
    assert find_sense(held) == sign
    late = np.interp(TIME, [0, 1, 4, 6], [0.1, 0.1, 0.4, 0.15])
    stepped = build(sign * pull * late + noise, ON_AND_OFF[0], pull * np.array(ON_AND_OFF[1]))
    assert find_sense(stepped) == sign


def test_what_hardly_moves_has_no_sense(rng):
    noise = 0.02 * rng.standard_normal(TIME.size)
    assert find_sense(build(noise, *ON_AND_OFF)) == 0
    assert find_sense(build(CREEP, [0.0], [0.0])) == 0


def test_masked_frames_do_not_count(rng):
    trial = build(CREEP, *ON_AND_OFF)
    trial["joint_angle"][:, 40:80] = -3.0
    trial["angle_flag"][:, 40:80] = 4
    assert find_sense(trial) == 1


def test_a_campaign_is_refused_when_most_trials_move_against_the_load():
    good, bad = build(CREEP, *ON_AND_OFF), build(-CREEP, *ON_AND_OFF)
    refuse_wrong_sign("mine", [good, good, bad])
    refuse_wrong_sign("mine", [good, bad])
    with pytest.raises(CampaignFault, match=r"(?s)mine.*2 of 3 trials move against the load"):
        refuse_wrong_sign("mine", [bad, good, bad])
