import numpy as np
import pytest
from example_artifacts import CENTRE, LOAD, creep, make_angles

from softfinger.summary.prior_predictive import compute_prior_predictive, span_recordings


def test_a_prior_without_spread_expects_one_motion(artifacts):
    prior = artifacts["posterior"]["prior"].dataset.copy(deep=True)
    for place, name in enumerate(["log_k_v", "log_c_v", "log_c_p", "q_ini"]):
        prior[f"mu_{name}"] = prior[f"mu_{name}"] * 0 + CENTRE[place]
        prior[f"sigma_{name}"] = prior[f"sigma_{name}"] * 0 + 1e-12
    found = compute_prior_predictive(prior, artifacts["angles"], np.random.default_rng(1))
    own = np.array([*np.exp(CENTRE[:3]), CENTRE[3]])
    expected = creep(own, found["time"].values, LOAD)
    for quantile in found["quantile"]:
        angle = found["joint_angle_quantile"].sel(quantile=quantile, joint=2)
        np.testing.assert_allclose(angle, expected, rtol=1e-9)


def test_quantiles_rise_and_widen_with_the_prior(artifacts):
    prior = artifacts["posterior"]["prior"].dataset
    found = compute_prior_predictive(prior, artifacts["angles"], np.random.default_rng(1))
    assert (found["joint_angle_quantile"].diff("quantile") >= 0).all()
    assert found["joint_angle_quantile"].dims == ("quantile", "joint", "time")


def test_recordings_of_other_loads_are_not_mixed_in(artifacts):
    angles = make_angles(load_kind="command", load_scale=2500.0)
    prior = artifacts["posterior"]["prior"].dataset
    found = compute_prior_predictive(prior, angles, np.random.default_rng(1))
    assert float(found["load"]) == pytest.approx(100.0)
    of_load = angles["load_torque"].values[:, 0] == 100.0
    expected = angles["joint_angle"].values[of_load, 1].max()
    assert float(found["recorded_high"].sel(joint=2).max()) <= expected + 1e-12


def test_flagged_frames_do_not_widen_the_span():
    angles = make_angles(n_trial=2, n_joint=1)
    angles["joint_angle"][0, 0, 20] = 9.0
    angles["angle_flag"][0, 0, 20] = 4
    _, high = span_recordings(angles, angles["time"].values[0])
    assert high.max() < 2.0


def test_beyond_the_recordings_there_is_no_span():
    angles = make_angles(n_trial=2, n_joint=1)
    low, high = span_recordings(angles, np.array([10.0, 31.0]))
    assert np.isfinite([low[0, 0], high[0, 0]]).all()
    assert np.isnan([low[0, 1], high[0, 1]]).all()
