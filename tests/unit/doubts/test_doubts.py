"""Each kind of mistake is doubted by name, and a right campaign is not."""

import numpy as np
import pytest
import xarray as xr
from tests.unit.doubts.conftest import build_angles

from softfinger.artifacts import list_faults
from softfinger.artifacts.specs.doubts import SPEC
from softfinger.doubts import find_doubts, tabulate_doubts


def multiply(name, factor, trials=slice(None)):
    def change(angles):
        angles[name][trials] *= factor

    return change


def add(name, amount, trials=slice(None)):
    def change(angles):
        angles[name][trials] += amount

    return change


def on_angle(function, trials=(2,)):
    def change(angles):
        for k in trials:
            angles["joint_angle"][k] = function(angles["joint_angle"][k].to_numpy().copy())

    return change


def freeze(angle):
    angle[0, 100:] = angle[0, 100]
    return angle


def clip(angle):
    angle[1] = np.minimum(angle[1], np.quantile(angle[1], 0.85))
    return angle


def turn_joint(angle):
    angle[1] *= -1.0
    return angle


def wrap(angle):
    angle[0, 90:] -= 2 * np.pi
    return angle


def cut(angle):
    angle[2, -1] = 0.9
    return angle


def copy_trial(angles):
    angles["joint_angle"][3] = np.roll(angles["joint_angle"][1].to_numpy(), 5, axis=1) + 0.01


def repeat_frames(angles):
    angles["angle_flag"][:, :, np.arange(240) % 4 > 0] = 2


def hold_joint(angle, part=0.05):
    angle[1] = part * angle[1] + 0.002 * np.random.default_rng(4).standard_normal(240)
    return angle


def bridge(angle):
    for first, last in ((60, 75), (130, 139)):
        part = np.linspace(0.0, 1.0, last - first + 1)
        angle[:, first : last + 1] = angle[:, [first]] + np.diff(angle[:, [first, last]]) * part
    return angle


def repeat_rows(angle):
    angle[:, 150:200] = angle[:, 90:140]
    return angle


def paste_rows(angles):
    angles["joint_angle"][3, :, 150:190] = angles["joint_angle"][1, :, 30:70].to_numpy()


def cut_log(angles):
    angles["load_time"][2] = np.minimum(angles["load_time"][2], 4.0)
    angles["load_torque"][2] = np.array([0.0, 0.0, 0.04, 0.04, 0.04, 0.04])


def cut_logs(angles):
    angles["load_time"][:] = np.minimum(angles["load_time"], 4.0)
    angles["load_torque"][:] = np.array([0.0, 0.0, 0.04, 0.04, 0.04, 0.04])
    fall = np.exp(-(np.arange(240) - 150).clip(0) / 20.0)
    angles["joint_angle"][:] *= np.where(np.arange(240) > 150, fall, 1.0)


def no_log(angles):
    angles["load_time"] += 3600.0


EVERY, ONE, HALF = range(7), (2,), (1, 3, 5)
MISTAKES = [
    (multiply("load_torque", 102.0, [2]), "scale_of_trials", ["t2"]),
    (multiply("load_torque", 1e-3, [1, 3, 5]), "scale_of_trials", ["t1", "t3", "t5"]),
    (multiply("load_torque", 102.0), "dimension", []),
    (multiply("joint_angle", np.pi / 180, [2]), "scale_of_trials", ["t2"]),
    (multiply("joint_angle", np.pi / 180, [2]), "noise_of_trials", ["t2"]),
    (on_angle(hold_joint), "scale_of_joint", ["t2"]),
    (on_angle(lambda a: hold_joint(a, 0.01), EVERY), "joint_hardly_moves", []),
    (multiply("time", 1e3), "frame_interval", []),
    (multiply("time", 1e3), "trials_overlap", ["t0"]),
    (multiply("time", 2.0, [2]), "frame_interval_of_trials", ["t2"]),
    (multiply("load_time", 1e3, [2]), "span_of_load_log", ["t2"]),
    (multiply("started_at", 0.0), "equal_starts", ["t0"]),
    (add("load_time", 1.0), "load_shifted", ["t0"]),
    (add("time", -1.0), "load_shifted", ["t0"]),
    (add("time", 2.0, [2]), "begins_late", ["t2"]),
    (no_log, "motion_without_load", ["t0"]),
    (on_angle(lambda a: a[:, ::-1]), "load_unrelated", ["t2"]),
    (on_angle(lambda a: 0.001 * a + 0.002 * np.sin(np.outer([7, 9, 8], np.arange(240) ** 2))),
     "load_without_motion", ["t2"]),
    (multiply("joint_angle", -1.0, [2]), "against_the_load", ["t2"]),
    (on_angle(turn_joint, EVERY), "against_the_load", ["t0"]),
    (on_angle(lambda a: np.cumsum(a, axis=0)), "absolute_angles", ["t2"]),
    (on_angle(lambda a: np.cumsum(a, axis=0), HALF), "absolute_angles", ["t1"]),
    (on_angle(lambda a: a[[1, 0, 2]]), "joints_exchanged", ["t2"]),
    (on_angle(lambda a: a[[0, 2, 1]], EVERY), "joints_exchanged", ["t0"]),
    (on_angle(lambda a: a + 0.5), "offset", ["t2"]),
    (on_angle(lambda a: a + 1.57, EVERY), "far_from_straight", []),
    (on_angle(freeze), "stuck", ["t2"]),
    (on_angle(clip), "clipped", ["t2"]),
    (on_angle(lambda a: np.round(a, 1)), "quantised", ["t2"]),
    (on_angle(wrap), "wrapped", ["t2"]),
    (on_angle(cut), "last_row", ["t2"]),
    (repeat_frames, "repeated_frames", ["t0"]),
    (copy_trial, "copies", ["t1", "t3"]),
    (on_angle(repeat_rows), "repeated_part", ["t2"]),
    (paste_rows, "shared_part", ["t1", "t3"]),
    (on_angle(bridge), "bridged_gaps", ["t2"]),
    (on_angle(lambda a: a - a[:, [0]], HALF), "zeroed", ["t1", "t3", "t5"]),
    (on_angle(lambda a: a - a[:, :30].mean(axis=1, keepdims=True), HALF), "zeroed", ["t1"]),
    (on_angle(lambda a: a - np.median(a[:, :31], axis=1, keepdims=True)), "zeroed", ["t2"]),
    (cut_log, "log_ends_early", ["t2"]),
    (cut_logs, "log_ends_early", ["t0"]),
    (on_angle(lambda a: a * np.array([[1.0], [57.3], [1.0]]), EVERY), "unit_of_joint", []),
    (on_angle(lambda a: a * np.array([[1.0], [57.3], [1.0]])), "unit_of_joint", ["t2"]),
    (on_angle(lambda a: a / np.array([[6.28], [1.0], [1.0]]), HALF), "unit_of_joint", ["t1"]),
    (multiply("covariate_value", 100.0), "covariate", ["t0"]),
    (add("covariate_value", 273.15, [2]), "covariate", ["t2"]),
    (multiply("link_mass", 1e3), "dimension", []),
    (multiply("wire_offset", 100.0, ()), "dimension", []),
    (lambda angles: angles.attrs.update(noise_sd_rad=0.17), "declared_noise", []),
]  # fmt: skip


@pytest.mark.parametrize(
    ("change", "kind", "trials"),
    MISTAKES,
    ids=[f"{k}_{kind}" for k, (_, kind, _) in enumerate(MISTAKES)],
)
def test_each_mistake_is_doubted_with_its_trials(angles, change, kind, trials):
    change(angles)
    said = {doubt.id: doubt for doubt in find_doubts(angles)}
    assert kind in said
    assert set(trials) <= set(said[kind].trials) or not trials
    assert said[kind].statement.isprintable()


@pytest.mark.parametrize("seed", range(5))
def test_right_campaigns_are_not_doubted(seed):
    assert find_doubts(build_angles(seed=seed)) == []
    assert find_doubts(build_angles(trials=1, seed=seed)) == []


def test_lines_of_rows_and_of_times_are_both_bridges(angles):
    angles["time"] += 0.4 / 30 * np.random.default_rng(5).random((7, 240))
    time, angle = angles["time"][2].to_numpy(), angles["joint_angle"][2].to_numpy().copy()
    for by in (time, np.arange(240.0)):
        new = angle.copy()
        new[1, 71:79] = np.interp(by[71:79], by[[70, 79]], angle[1, [70, 79]])
        angles["joint_angle"][2] = new
        (doubt,) = find_doubts(angles)
        assert (doubt.id, doubt.trials, doubt.joints) == ("bridged_gaps", ("t2",), (2,))


def test_a_last_row_among_outliers_is_one_of_them(angles):
    rng = np.random.default_rng(6)
    for trial in angles["joint_angle"].to_numpy():
        trial[1, rng.choice(np.arange(5, 235), 3, replace=False)] += 0.3
    angles["joint_angle"][2, 1, -1] += 0.3
    assert find_doubts(angles) == []


def test_a_coarse_sensor_copies_bridges_and_zeroes_nothing():
    angles = build_angles(seed=8)
    angles["joint_angle"] = (angles["joint_angle"] / 0.004).round() * 0.004
    assert find_doubts(angles) == []


def test_a_log_that_names_only_changes_may_end_early(angles):
    angles["load_time"] = angles["load_time"].clip(max=5.0)
    assert find_doubts(angles) == []


def test_a_zero_load_at_the_end_of_a_log_stays_zero(angles):
    fall = np.exp(-(np.arange(240) - 150).clip(0) / 20.0)
    angles["joint_angle"] *= xr.DataArray(np.where(np.arange(240) > 150, fall, 1.0), dims="frame")
    angles["load_torque"][:, 4:] = 0.0
    angles["load_time"] = angles["load_time"].clip(max=6.0)
    assert "log_ends_early" not in {doubt.id for doubt in find_doubts(angles)}


def test_doubts_become_an_artifact(angles):
    assert list_faults(SPEC, tabulate_doubts([], angles)) == []
    turn_joint(angles["joint_angle"].to_numpy()[2])
    table = tabulate_doubts(find_doubts(angles), angles)
    assert list_faults(SPEC, table) == []
    assert table["kind"].values.tolist() == ["against_the_load"]
    assert table["trial_doubted"].values[0].tolist() == [k == 2 for k in range(7)]
    assert table["joint_doubted"].values[0].tolist() == [False, True, False]
