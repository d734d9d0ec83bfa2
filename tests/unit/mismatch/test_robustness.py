"""Damaged and poor recordings: each gives a verdict or a sentence, never a traceback."""

import numpy as np
import pytest

from softfinger.faults import Fault
from softfinger.mismatch import diagnose

CONFIG = {
    "bootstrap_replicates": 99,
    "false_alarm_probability": 0.01,
    "sample_repaired": False,
    "longest_search_s": 600.0,
}


def quiet(items, _):
    return items


def keep_one_trial(angles, _):
    return angles.isel(trial=[2])


def lose_frames(angles, rng):
    angles["joint_angle"].values[rng.uniform(size=angles["joint_angle"].shape) < 0.3] = np.nan
    angles["joint_angle"].values[1, 0, 40:90] = np.nan
    return angles


def shake_the_clock(angles, rng):
    angles["time"].values[:, 1:] += rng.uniform(-0.03, 0.03, angles["time"].values[:, 1:].shape)
    return angles


def throw_in_outliers(angles, rng):
    angles["joint_angle"].values[rng.uniform(size=angles["joint_angle"].shape) < 0.01] += 0.2
    return angles


def forget_the_load_log(angles, _):
    count = angles.sizes["trial"]
    angles["load_kind"] = ("trial", ["assumed"] * count)
    angles["load_time"].values[:] = 0.0
    angles["load_torque"].values[:] = 1.0
    return angles


def scale_the_load(angles, _):
    angles["load_torque"] = 7.0 * angles["load_torque"]
    return angles


def hold_the_joint(angles, rng):
    angles["joint_angle"].values[:] = 0.002 * rng.standard_normal(angles["joint_angle"].shape)
    return angles


def freeze_the_joint(angles, _):
    angles["joint_angle"].values[:] = 0.1
    return angles


def cut_short(angles, _):
    return angles.isel(frame=slice(0, 12))


DAMAGES = [
    keep_one_trial, lose_frames, shake_the_clock, throw_in_outliers, hold_the_joint,
    freeze_the_joint, cut_short,
]  # fmt: skip


@pytest.mark.parametrize("damage", DAMAGES, ids=lambda damage: damage.__name__)
def test_every_damage_ends_in_a_verdict_or_a_sentence(draw_campaign, damage):
    angles = damage(draw_campaign(6, 0.0).copy(deep=True), np.random.default_rng(8))
    problems = []
    try:
        verdict = diagnose(angles, CONFIG, 3, quiet).verdict
        problems += [] if np.isfinite(verdict.residual_rms_rad.final) else ["no residual"]
    except Fault as fault:
        problems += [] if len(str(fault)) > 40 else [f"no sentence: {fault}"]
    assert problems == []


def test_without_a_load_log_lags_cannot_be_told(draw_campaign):
    angles = forget_the_load_log(draw_campaign(6, 0.0), None)
    verdict = diagnose(angles, CONFIG, 3, quiet).verdict
    assert {"actuator_lag", "camera_delay"} <= set(verdict.not_testable)
    assert np.isfinite(verdict.residual_rms_rad.final)


def test_a_wrong_factor_on_the_load_changes_no_decision(draw_campaign):
    verdict = diagnose(scale_the_load(draw_campaign(2, 0.0), None), CONFIG, 5, quiet).verdict
    assert verdict.decision == "adequate"
    assert np.isfinite(verdict.residual_rms_rad.final)
