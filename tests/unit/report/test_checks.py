import numpy as np
import pytest
import xarray as xr
from example_artifacts import CONFIG, make_artifacts

from softfinger.faults import Fault, ListedFault
from softfinger.report.blocks import Check
from softfinger.report.checks import (
    check_calibration,
    check_computation,
    check_fit,
    combine,
    find_chance_limit,
    measure_shared_residual,
    pool_coverage,
)
from softfinger.report.config import read_config
from softfinger.report.material import Material
from softfinger.report.sections.outlook import list_data_limits, list_failed
from softfinger.report.sections.summary import describe_causes, describe_fit, judge


def find(checks, word):
    return next(check for check in checks if word in check.name)


def with_sampling(artifacts, **changes):
    sampling = artifacts["sampling"]
    limits = {name: value for name, value in changes.items() if name in sampling.attrs}
    values = {name: value for name, value in changes.items() if name not in limits}
    changed = sampling.assign(values).assign_attrs(limits)
    return Material({**artifacts, "sampling": changed}, read_config(CONFIG), CONFIG)


def test_each_limit_of_the_fit_decides_its_check(artifacts, material):
    found = {check.name: check.passed for check in check_computation(material)}
    assert found["largest R-hat"] is False
    assert found["fewest effective draws, bulk"] is True
    assert found["fewest effective draws, tail"] is False
    assert found["divergent transitions"] is True
    mild = check_computation(with_sampling(artifacts, r_hat_max=1.05, ess_min=300.0))
    assert all(check.passed for check in mild if "Pareto" not in check.name)


def test_limits_as_a_file_holds_them_decide_alike(artifacts):
    limits = {"r_hat_max": np.float64(1.001), "divergences_max": np.int64(0)}
    material = with_sampling(artifacts, divergences=1, **limits)
    failed = [check.name for check in check_computation(material) if check.failed]
    assert failed[0] == "largest R-hat"
    assert "divergent transitions" in failed
    assert judge(material)[0].answer == "not sound"
    assert list_failed(material)[0].startswith("Failed: largest R-hat")
    assert Check("", "", "", np.bool_(False), "").failed


def test_one_divergence_is_one_too_many(artifacts):
    check = find(check_computation(with_sampling(artifacts, divergences=1)), "divergent")
    assert (check.found, check.passed) == ("1", False)


def test_the_hyperparameter_whose_chains_agree_least_is_shown(material):
    assert material.sampling["worst_quantity"].item() == "mu_log_k_v[1]"
    draws = material.posterior["mu_log_k_v"].sel(joint=1).values
    expected = (draws - draws.mean()) / draws.std()
    np.testing.assert_allclose(material.sampling["worst_draws"], expected)


def test_the_largest_pareto_k_of_leaving_one_trial_out_is_found(artifacts):
    for refitted, passed in ((True, True), (False, False)):
        scores = {
            "pareto_k": ("trial", [0.1, 0.3, 0.9, 0.2, 0.5]),
            "refitted": ("trial", [False, False, refitted, False, False]),
        }
        tree = artifacts["posterior"].copy(deep=True)
        tree["leave_one_out"] = xr.DataTree(xr.Dataset(scores))
        material = Material({**artifacts, "posterior": tree}, read_config(CONFIG), CONFIG)
        check = find(check_computation(material), "Pareto")
        assert check.passed is passed
        assert ("0 of 5 trials" in check.found) is passed


def test_what_the_fit_did_not_keep_is_said_to_be_not_made(material):
    check = find(check_computation(material), "Pareto")
    assert check.passed is None
    assert "no log-likelihood" in check.found


def test_residuals_that_trials_share_fail(artifacts):
    angles = artifacts["angles"].copy(deep=True)
    clean = Material(artifacts, read_config(CONFIG), CONFIG)
    assert all(check.passed for check in check_fit(clean))
    angles["joint_angle"] = angles["joint_angle"] + 0.02 * np.sin(angles["time"])
    bent = Material({**artifacts, "angles": angles}, read_config(CONFIG), CONFIG)
    assert not find(check_fit(bent), "shared").passed
    assert judge(bent)[2].passed is False


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


def test_a_single_trial_shares_nothing():
    material = Material(make_artifacts(n_trial=1, n_joint=1), read_config(CONFIG), CONFIG)
    assert [check.passed for check in check_fit(material)] == [None] * 3


@pytest.mark.parametrize(
    ("n_trial", "held", "passed"),
    [(5, 0.88, True), (5, 0.6, False), (2, 1.0, True), (41, 1.0, False)],
)
def test_coverage_far_from_its_claim_fails(n_trial, held, passed):
    artifacts = make_artifacts(n_trial=n_trial, n_joint=1)
    bands = artifacts["bands"].copy(deep=True)
    bands["coverage"].values = np.full(bands["coverage"].shape, held)
    bands["coverage_bound"].values = np.full(bands["coverage_bound"].shape, held)
    material = Material({**artifacts, "bands": bands}, read_config(CONFIG), CONFIG)
    assert find(check_calibration(material), "whole").passed is passed


def test_few_trials_excuse_a_coverage_that_they_cannot_tell_from_the_claim(artifacts):
    bands = artifacts["bands"].copy(deep=True)
    bands["coverage"].values = np.full(bands["coverage"].shape, 0.8)
    bands["coverage_bound"].values[..., 0] = 0.6
    bands["coverage_bound"].values[..., 1] = 1.0
    material = Material({**artifacts, "bands": bands}, read_config(CONFIG), CONFIG)
    assert find(check_calibration(material), "whole").passed


def test_coverage_is_pooled_by_trials():
    bands = make_artifacts(load_kind="command", load_scale=2500.0)["bands"]
    bands["coverage"].values[:, 0] = 0.5
    bands["coverage"].values[:, 1] = 1.0
    bands["recorded_n"].values[0] = 3
    bands["recorded_n"].values[1] = 1
    pooled = pool_coverage(bands, 0.9, "whole")
    np.testing.assert_allclose(pooled["coverage"], 0.625)


def test_a_missing_artifact_is_not_judged(artifacts):
    bare = Material({"angles": artifacts["angles"]}, read_config(CONFIG), CONFIG)
    assert [tile.passed for tile in judge(bare)] == [None] * 4


def test_one_failure_outweighs_everything():
    good, bad, open_ = (Check("", "", "", passed, "") for passed in (True, False, None))
    assert combine((good, bad, open_)) is False
    assert combine((good, open_)) is True
    assert combine((open_,)) is None


def test_a_report_about_no_recordings_is_refused(artifacts):
    with pytest.raises(Fault, match="angles"):
        Material({"bands": artifacts["bands"]}, read_config(CONFIG), CONFIG)


def test_unknown_limits_are_refused_with_their_names():
    with pytest.raises(ListedFault, match="r_hat_min"):
        read_config({"report": {**CONFIG["report"], "r_hat_min": 1.0}})


def test_one_trial_is_not_judged_by_what_needs_two():
    artifacts = make_artifacts(n_trial=1)
    scores = xr.Dataset({"refitted": ("trial", [False]), "pareto_k": ("trial", [2.1])})
    artifacts["posterior"]["leave_one_out"] = xr.DataTree(scores)
    material = Material(artifacts, read_config(CONFIG), CONFIG)
    checks = [find(check_computation(material), "Pareto"), *check_calibration(material)]
    assert {(check.found, check.passed) for check in checks} == {("needs two trials", None)}
    assert [tile.answer for tile in judge(material)[1:3]] == ["not judged", "not judged"]
    assert {check.found for check in check_fit(material)} == {"needs two trials"}
    said = describe_fit(material)
    assert "±" not in said[0]
    assert "One trial cannot tell" in said[1]
    assert describe_causes(material) == []
    assert "1 trial tells nothing of the spread" in list_data_limits(material)[0]
