import numpy as np
import pytest
import xarray as xr
from example_artifacts import LOAD, creep, make_parameters

from softfinger.report.residuals import compute_residuals, find_jumps, find_segments

RING = 3.4  # Hz


def make_campaign(n_trial=6, *, ring=0.0, noise=0.001, fall_at=None, seed=5):
    """Trials of two joints at 33 Hz whose motion is the model's, but for a ring at joint 2."""
    time = np.arange(200) * 0.03
    own = make_parameters(n_trial, 2)
    angle = creep(own, time, LOAD)
    angle[:, 1] += ring * np.exp(-time) * np.sin(2 * np.pi * RING * time)
    angle += noise * np.random.default_rng(seed).standard_normal(angle.shape)
    knots = [0.0, 6.0] if fall_at is None else [0.0, fall_at, fall_at, 6.0]
    load = [LOAD, LOAD] if fall_at is None else [LOAD, LOAD, 0.0, 0.0]
    dims = ("trial", "joint", "frame")
    angles = xr.Dataset(
        {
            "time": (("trial", "frame"), np.tile(time, (n_trial, 1))),
            "joint_angle": (dims, angle),
            "angle_flag": (dims, np.zeros(angle.shape, np.uint8)),
            "load_time": (("trial", "knot"), np.tile(knots, (n_trial, 1))),
            "load_torque": (("trial", "knot"), np.tile(load, (n_trial, 1))),
        },
        coords={"trial": [f"t{i}" for i in range(n_trial)], "joint": [1, 2]},
        attrs={"source": "measured"},
    )
    names = ("k_v", "c_v", "c_p", "q_ini")
    parameters = xr.Dataset(
        {name: (("trial", "joint"), own[..., i]) for i, name in enumerate(names)},
        coords={"trial": angles["trial"], "joint": angles["joint"]},
    )
    return angles, parameters


def test_the_models_own_motion_leaves_nothing():
    residuals = compute_residuals(*make_campaign(noise=0.0))
    assert float(np.abs(residuals["residual"]).max()) < 1e-12


def test_evenly_spaced_frames_fill_every_bin():
    residuals = compute_residuals(*make_campaign())
    assert residuals["mean_residual"].notnull().all()
    assert residuals.sizes["since_change"] == 200


def test_a_ring_is_found_at_its_joint_and_frequency():
    residuals = compute_residuals(*make_campaign(ring=0.01)).sel(change="rise")
    assert float(residuals["peak_frequency"].sel(joint=2)) == pytest.approx(RING, abs=0.1)
    assert np.isnan(residuals["peak_frequency"].sel(joint=1))


def test_noise_does_not_ring():
    found = [
        compute_residuals(*make_campaign(noise=0.01, seed=seed))["peak_frequency"].values
        for seed in range(40)
    ]
    assert np.isnan(found).all()


def test_the_mean_residual_is_the_shared_motion_and_its_error_is_honest():
    angles, parameters = make_campaign(n_trial=40, noise=0.003)
    angles["joint_angle"] = angles["joint_angle"] + 0.002
    residuals = compute_residuals(angles, parameters)
    assert float(residuals["mean_residual"].mean()) == pytest.approx(0.002, abs=1e-4)
    error = float(np.sqrt((residuals["residual_se"] ** 2).mean()))
    assert error == pytest.approx(0.003 / np.sqrt(40), rel=0.05)


def test_flagged_frames_take_no_part():
    angles, parameters = make_campaign(noise=0.0)
    angles["joint_angle"][2, 0, 30] = 9.0
    angles["angle_flag"][2, 0, 30] = 4
    residuals = compute_residuals(angles, parameters)
    assert np.isnan(residuals["residual"].values[2, 0, 30])
    assert float(np.abs(residuals["residual"]).max()) < 1e-12


def test_rise_and_fall_are_kept_apart():
    angles, parameters = make_campaign(fall_at=3.0)
    residuals = compute_residuals(angles, parameters)
    assert residuals["change"].values.tolist() == ["rise", "fall"]
    assert residuals["n_segments"].values.tolist() == [6, 6]
    assert float(residuals["since_change"].max()) == pytest.approx(3.0, abs=0.05)


def test_a_load_without_jumps_counts_from_its_first_knot():
    angles, _ = make_campaign(n_trial=1)
    angles["load_time"] = (("trial", "knot"), [[1.0, 6.0]])
    angles["load_torque"] = (("trial", "knot"), [[0.0, LOAD]])
    assert find_segments(angles) == [("rise", 0, 1.0, np.inf)]


def test_small_steps_of_a_logged_load_are_no_changes():
    time = np.array([0.0, 2.0, 2.0, 4.0])
    assert find_jumps(time, np.array([1.0, 1.0, 1.04, 1.04])) == [(0.0, 1.0)]


def test_a_single_trial_is_its_own_mean_and_has_no_error():
    residuals = compute_residuals(*make_campaign(n_trial=1))
    own = residuals["residual"].isel(trial=0)
    np.testing.assert_allclose(residuals["mean_residual"].sel(change="rise"), own)
    assert np.isnan(residuals["residual_se"]).all()


def test_trials_of_different_length_are_averaged_where_they_reach():
    angles, parameters = make_campaign()
    angles["time"][0, 100:] = np.nan
    angles["joint_angle"][0, :, 100:] = np.nan
    angles["angle_flag"][0, :, 100:] = 1
    residuals = compute_residuals(angles, parameters)
    assert np.isfinite(residuals["mean_residual"]).all()
