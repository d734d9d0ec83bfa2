import numpy as np
import pytest
import xarray as xr
from example_artifacts import LOAD, creep, make_parameters

from softfinger.inference.motion import move_paper_joint
from softfinger.summary.motion import compute_fitted_angle
from softfinger.summary.residuals import find_segments, list_load_jumps, summarise_residuals

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
    own[..., :3] = np.log(own[..., :3])
    names = ("log_k_v", "log_c_v", "log_c_p", "q_ini")
    dims = ("chain", "draw", "trial", "joint")
    drawn = {name: (dims, own[None, None, ..., i]) for i, name in enumerate(names)}
    drawn["noise_sd"] = (("chain", "draw", "joint"), np.full((1, 1, 2), noise))
    coords = {"trial": angles["trial"], "joint": angles["joint"]}
    return angles, xr.Dataset(drawn, coords)


def compute_residuals(angles, posterior):
    return summarise_residuals(angles, posterior, compute_fitted_angle(angles, posterior))


def test_the_models_own_motion_leaves_nothing():
    residuals = compute_residuals(*make_campaign(noise=0.0))
    assert float(residuals["residual_rms"].max()) < 1e-12
    assert float(residuals["largest_share"]) < 1e-12


def test_evenly_spaced_frames_fill_every_bin():
    residuals = compute_residuals(*make_campaign())
    assert residuals["mean_residual"].notnull().all()
    assert residuals.sizes["since_change"] == 200


def test_a_ring_is_found_at_its_joint_and_frequency():
    residuals = compute_residuals(*make_campaign(ring=0.01)).sel(change="rise")
    assert float(residuals["peak_frequency"].sel(joint=2)) == pytest.approx(RING, abs=0.1)
    assert residuals["rings"].values.tolist() == [round(float(residuals["peak_frequency"][1]), 1)]
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
    assert float(residuals["residual_rms"].max()) < 1e-12
    assert float(np.abs(residuals["mean_residual"]).max()) < 1e-12


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
    assert list_load_jumps(time, np.array([1.0, 1.0, 1.04, 1.04])) == [(0.0, 1.0)]


def test_a_single_trial_is_its_own_mean_and_has_no_error():
    residuals = compute_residuals(*make_campaign(n_trial=1))
    rms = np.sqrt((residuals["mean_residual"].sel(change="rise") ** 2).mean("since_change"))
    np.testing.assert_allclose(rms, residuals["residual_rms"])
    assert np.isnan(residuals["residual_se"]).all()


def test_trials_of_different_length_are_averaged_where_they_reach():
    angles, parameters = make_campaign()
    angles["time"][0, 100:] = np.nan
    angles["joint_angle"][0, :, 100:] = np.nan
    angles["angle_flag"][0, :, 100:] = 1
    residuals = compute_residuals(angles, parameters)
    assert np.isfinite(residuals["mean_residual"]).all()


def test_noise_and_the_share_of_the_range_stand_beside_the_residual():
    angles, posterior = make_campaign(n_trial=40, noise=0.003)
    angles["joint_angle"] = angles["joint_angle"] + 0.01
    found = compute_residuals(angles.assign_attrs(noise_sd_rad=0.002), posterior)
    np.testing.assert_allclose(found["noise_mean"], 0.003)
    assert float(found["noise_declared"]) == 0.002
    span = float(angles["joint_angle"].max() - angles["joint_angle"].min())
    assert float(found["largest_share"]) == pytest.approx(float(found["largest_mean"].max()) / span)


def test_trials_that_the_fit_left_out_are_left_out():
    angles, posterior = make_campaign()
    found = compute_residuals(angles, posterior.isel(trial=[4, 1, 2]))
    assert found["n_segments"].values.tolist() == [3]
    assert float(found["residual_rms"].max()) < 0.002


def test_any_model_may_move_the_trials():
    angles, posterior = make_campaign(noise=0.0)
    asked = []

    def move(own, draw, like, time, *load):
        asked.append((int(draw[0]), int(like[0])))
        return move_paper_joint(own, draw, like, time, *load) + 0.01

    fitted = compute_fitted_angle(angles, posterior, move)
    np.testing.assert_allclose(fitted - compute_fitted_angle(angles, posterior), 0.01)
    assert asked == [(0, place) for place in range(6)]
