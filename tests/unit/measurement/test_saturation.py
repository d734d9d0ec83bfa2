"""Readings at the end of a sensor's range, and frames that were flagged before."""

import numpy as np
import pytest

from softfinger.measurement.flags import JUMP, STALE
from softfinger.measurement.measure import measure
from softfinger.measurement.saturation import find_saturated_array, find_saturated_frames

TIME = np.arange(500) / 30
LOAD = ([0.0, 4.0, 4.0, 8.0, 8.0, 12.0, 12.0], [0.02, 0.02, 0.06, 0.06, 0.01, 0.01, 0.05])


@pytest.fixture
def campaign(make_campaign):
    return make_campaign(np.random.default_rng(4), 6, time=TIME, load=LOAD, rho=0.0)[0]


def clip(angles, joint, limit):
    values = angles["joint_angle"].values.copy()
    values[:, joint] = np.minimum(values[:, joint], limit)
    return angles.assign(joint_angle=(angles["joint_angle"].dims, values))


@pytest.fixture
def clipped(campaign):
    limit = float(np.quantile(campaign["joint_angle"].values[:, 1], 0.85))
    return clip(campaign, 1, limit), campaign["joint_angle"].values[:, 1] > limit


def test_sound_recordings_have_no_limit(campaign):
    assert not find_saturated_frames(campaign).any()


def test_angles_at_a_limit_are_found_in_their_joint(clipped):
    found = find_saturated_frames(clipped[0])
    assert found[:, 1][clipped[1]].all()
    assert not found[:, [0, 2]].any()
    assert found[:, 1].sum() < 1.1 * clipped[1].sum()


def test_what_is_let_through_beside_the_limit_counts_as_at_it(clipped):
    """Without the values that noise let through, the mean of the rest is not pulled down."""
    angles, beyond = clipped
    found = find_saturated_frames(angles)[:, 1]
    assert (found & ~beyond).any()


def test_frames_at_a_limit_are_absent_and_a_finding(clipped):
    angles, beyond = clipped
    found = measure(angles, np.zeros(angles["joint_angle"].shape) + 0.0)
    assert not (found["used"].values & beyond).any()
    assert not found["repeated"].any()
    sizes = dict(
        zip(found["component"].values.tolist(), found["component_size"].values, strict=True)
    )
    assert sizes["saturated_sensor"] == pytest.approx(beyond.mean(), rel=0.2)
    assert "lost_frames" not in sizes


def test_a_specimen_at_its_limit_does_not_repeat_its_frames(clipped):
    alone = clipped[0].isel(joint=[1], other_joint=[1])
    found = measure(alone)
    assert not found["repeated"].any()
    assert found["saturated"].values[clipped[1]].all()


def test_few_equal_extremes_are_no_limit():
    noisy = np.random.default_rng(1).standard_normal((4, 200))
    noisy[0, [20, 60, 100, 140, 180]] = noisy[1, 50] = 4.0
    assert not find_saturated_array(noisy).any()
    noisy[2, [20, 60, 100]] = 4.0
    assert find_saturated_array(noisy).sum() == 9


def test_coarsely_rounded_and_resting_readings_are_at_no_limit():
    rng = np.random.default_rng(2)
    hold = np.repeat([0.0, 1.0, 0.5], 100) + 0.01 * rng.standard_normal((5, 300))
    assert not find_saturated_array(np.round(hold, 1)).any()
    at_rest = hold.copy()
    at_rest[:, :100] = at_rest.min() - 0.01
    assert not find_saturated_array(at_rest).any()


def test_a_load_cell_at_its_limit_leaves_what_follows_unknown(campaign):
    knot = np.tile(np.arange(0.0, 16.0, 0.25), (6, 1))
    load = 0.05 * (knot > 4.0) + 0.03 * (knot > 9.0)
    load = load + 0.001 * np.random.default_rng(3).standard_normal(load.shape)
    sound = campaign.drop_dims("knot").assign(
        load_time=(("trial", "knot"), knot), load_torque=(("trial", "knot"), load)
    )
    assert not find_saturated_frames(sound).any()
    limited = sound.assign(load_torque=(("trial", "knot"), np.minimum(load, 0.075)))
    found = find_saturated_frames(limited)
    assert found[:, :, TIME > 10.0].all()
    assert not found[:, :, TIME < 9.0].any()


def test_a_load_that_has_gone_is_at_no_limit(campaign):
    """A cell whose gain drifts reads another load in every row, and 0 whenever none acts."""
    knot = np.tile(np.arange(0.0, 16.0, 0.25), (6, 1))
    drift = 1.0 - 1e-3 * knot * np.linspace(0.5, 1.5, 6)[:, None] ** 2
    load = np.where((knot > 1.0) & (knot < 9.0), 0.04 * drift, 0.0)
    angles = campaign.drop_dims("knot").assign(
        load_time=(("trial", "knot"), knot), load_torque=(("trial", "knot"), load)
    )
    assert not find_saturated_frames(angles).any()


def test_flagged_repeats_are_repeats_and_no_frame_is_lost(campaign):
    flag = campaign["angle_flag"].copy()
    flag[:, :, 100:120] |= STALE
    flag[:, 0, 300:304] |= JUMP
    found = measure(campaign.assign(angle_flag=flag))
    assert found["repeated"].values[:, 100:120].all()
    assert found["lost"] == 0.0
    assert not found["used"].values[:, 100:120].any()
    still = np.zeros(campaign["joint_angle"].shape)
    found = measure(campaign.assign(angle_flag=flag), still)
    size = found["component_size"].sel(component="outliers")
    assert size == pytest.approx(4 / 480, rel=0.3)
