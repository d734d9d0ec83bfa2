import numpy as np
import pytest
import xarray as xr
from example_artifacts import CONFIG, make_artifacts

from softfinger.faults import ListedFault
from softfinger.summary.calibration import bound_error, pool_coverage, summarise_calibration
from softfinger.summary.checks import (
    check_calibration,
    find_chance_limit,
    gather_checks,
    measure_shared_residual,
)
from softfinger.summary.config import read_config


def test_the_shared_residual_is_one_for_independent_trials():
    rng = np.random.default_rng(8)
    trials = rng.standard_normal((50, 1, 2, 400)).cumsum(axis=-1)  # strongly autocorrelated
    dims = ("change", "joint", "since_change")
    residuals = xr.Dataset(
        {
            "mean_residual": (dims, trials.mean(axis=0)),
            "residual_se": (dims, trials.std(axis=0, ddof=1) / np.sqrt(50)),
        }
    )
    assert 0.3 < measure_shared_residual(residuals) < 2.0


def test_chance_alone_rarely_exceeds_its_limit_even_if_every_moment_is_the_same():
    rng = np.random.default_rng(4)
    dims = ("change", "joint", "since_change")
    alarms = 0
    for _ in range(400):
        trials = np.repeat(rng.standard_normal((6, 1, 3, 1)), 5, axis=-1)
        residuals = xr.Dataset(
            {
                "mean_residual": (dims, trials.mean(axis=0)),
                "residual_se": (dims, trials.std(axis=0, ddof=1) / np.sqrt(6)),
                "n_segments": ("change", [6]),
            }
        )
        alarms += measure_shared_residual(residuals) > find_chance_limit(residuals)
    assert 0.02 < alarms / 400 < 0.08


def test_coverage_is_pooled_by_trials():
    bands = make_artifacts(load_kind="command", load_scale=2500.0)["bands"]
    bands["coverage"].values[:, 0] = 0.5
    bands["coverage"].values[:, 1] = 1.0
    bands["recorded_n"].values[0] = 3
    bands["recorded_n"].values[1] = 1
    np.testing.assert_allclose(pool_coverage(bands, 0.9, "whole"), 0.625)


def test_protocols_have_their_loads_and_trials():
    artifacts = make_artifacts(load_kind="command", load_scale=2500.0)
    found = summarise_calibration(artifacts["bands"], artifacts["angles"], 0.9)
    assert found["protocol_load"].values.tolist() == [100.0, 200.0]
    assert found["protocol_trials"].values.tolist() == [5, 5]


def test_no_calibrated_campaign_errs_more_than_the_bound():
    rng = np.random.default_rng(2)
    inside = rng.random((2000, 8)) < 0.9  # trials lie inside as a whole or not at all
    assert inside.mean(axis=1).std() == pytest.approx(bound_error(0.9, 8), rel=0.05)


def test_the_worst_joint_is_held_against_the_limits_that_are_shown():
    artifacts = make_artifacts(n_trial=4)
    bands = artifacts["bands"].copy(deep=True)
    bands["coverage"].values[..., 1, 1] = 0.5
    calibration = summarise_calibration(bands, artifacts["angles"], 0.9)
    checks = gather_checks(list(check_calibration(calibration, 4, 0.05))).sel(check="coverage")
    assert (int(checks["joint"]), int(checks["passed"])) == (2, 0)
    assert float(checks["value"]) < float(checks["lower"]) == pytest.approx(0.6)


def test_unknown_limits_are_refused_with_their_names():
    with pytest.raises(ListedFault, match="r_hat_min"):
        read_config({**CONFIG["report"], "r_hat_min": 1.0})
