import numpy as np
import pytest
import xarray as xr
from example_artifacts import CONFIG, gather, make_artifacts

from softfinger.faults import Fault
from softfinger.report.blocks import Check
from softfinger.report.checks import CALIBRATION, COMPUTATION, FIT, combine_checks, list_checks
from softfinger.report.material import Material
from softfinger.report.overview.causes import describe_causes
from softfinger.report.overview.spread import build_spread
from softfinger.report.sections.outlook import list_data_limits, list_failed
from softfinger.report.sections.tiles import judge_tiles


def find(checks, word):
    return next(check for check in checks if word in check.name)


def list_computation(material):
    return list_checks(material, COMPUTATION)


def list_fit(material):
    return list_checks(material, FIT)


def list_calibration(material):
    return list_checks(material, CALIBRATION)


def with_sampling(artifacts, **changes):
    sampling = artifacts["sampling"]
    limits = {name: value for name, value in changes.items() if name in sampling.attrs}
    values = {name: value for name, value in changes.items() if name not in limits}
    changed = sampling.assign(values).assign_attrs(limits)
    return gather({**artifacts, "sampling": changed})


def test_each_limit_of_the_fit_decides_its_check(artifacts, material):
    found = {check.name: check.passed for check in list_computation(material)}
    assert found["largest R-hat"] is False
    assert found["fewest effective draws, bulk"] is True
    assert found["fewest effective draws, tail"] is False
    assert found["divergent transitions"] is True
    mild = list_computation(with_sampling(artifacts, r_hat_max=1.05, ess_min=300.0))
    assert all(check.passed for check in mild if "Pareto" not in check.name)


def test_limits_as_a_file_holds_them_decide_alike(artifacts):
    limits = {"r_hat_max": np.float64(1.001), "divergences_max": np.int64(0)}
    material = with_sampling(artifacts, divergences=1, **limits)
    failed = [check.name for check in list_computation(material) if check.failed]
    assert failed[0] == "largest R-hat"
    assert "divergent transitions" in failed
    assert judge_tiles(material)[0].answer == "not sound"
    assert list_failed(material)[0].startswith("Failed: largest R-hat")
    assert Check("", "", "", np.bool_(False), "").failed


def test_one_divergence_is_one_too_many(artifacts):
    check = find(list_computation(with_sampling(artifacts, divergences=1)), "divergent")
    assert (check.found, check.passed) == ("1", False)


def test_the_largest_pareto_k_of_leaving_one_trial_out_is_found(artifacts):
    for refitted, passed in ((True, True), (False, False)):
        scores = {
            "pareto_k": ("trial", [0.1, 0.3, 0.9, 0.2, 0.5]),
            "refitted": ("trial", [False, False, refitted, False, False]),
        }
        tree = artifacts["posterior"].copy(deep=True)
        tree["leave_one_out"] = xr.DataTree(xr.Dataset(scores))
        material = gather({**artifacts, "posterior": tree})
        check = find(list_computation(material), "Pareto")
        assert check.passed is passed
        assert ("0 of 5 trials" in check.found) is passed
        assert ("1 sampled anew" in check.found) is passed


def test_what_the_fit_did_not_keep_is_said_to_be_not_made(material):
    check = find(list_computation(material), "Pareto")
    assert check.passed is None
    assert "no log-likelihood" in check.found


def test_residuals_that_trials_share_fail(artifacts):
    angles = artifacts["angles"].copy(deep=True)
    clean = gather(artifacts)
    assert all(check.passed for check in list_fit(clean))
    angles["joint_angle"] = angles["joint_angle"] + 0.02 * np.sin(angles["time"])
    bent = gather({**artifacts, "angles": angles})
    assert not find(list_fit(bent), "shared").passed
    assert judge_tiles(bent)[2].passed is False


def test_a_single_trial_shares_nothing():
    material = gather(make_artifacts(n_trial=1, n_joint=1))
    assert [check.passed for check in list_fit(material)] == [None] * 3


@pytest.mark.parametrize(
    ("n_trial", "held", "passed"),
    [(5, 0.88, True), (5, 0.6, False), (2, 1.0, True), (41, 1.0, False)],
)
def test_coverage_far_from_its_claim_fails(n_trial, held, passed):
    artifacts = make_artifacts(n_trial=n_trial, n_joint=1)
    bands = artifacts["bands"].copy(deep=True)
    bands["coverage"].values = np.full(bands["coverage"].shape, held)
    bands["coverage_bound"].values = np.full(bands["coverage_bound"].shape, held)
    material = gather({**artifacts, "bands": bands})
    assert find(list_calibration(material), "whole").passed is passed


def test_few_trials_excuse_a_coverage_that_they_cannot_tell_from_the_claim(artifacts):
    bands = artifacts["bands"].copy(deep=True)
    bands["coverage"].values = np.full(bands["coverage"].shape, 0.8)
    bands["coverage_bound"].values[..., 0] = 0.6
    bands["coverage_bound"].values[..., 1] = 1.0
    material = gather({**artifacts, "bands": bands})
    assert find(list_calibration(material), "whole").passed


def test_a_missing_artifact_is_not_judged(artifacts):
    bare = gather({"angles": artifacts["angles"]})
    assert [tile.passed for tile in judge_tiles(bare)] == [None] * 4


def test_one_failure_outweighs_everything():
    good, bad, open_ = (Check("", "", "", passed, "") for passed in (True, False, None))
    assert combine_checks((good, bad, open_)) is False
    assert combine_checks((good, open_)) is True
    assert combine_checks((open_,)) is None


def test_a_report_about_no_recordings_is_refused(artifacts):
    with pytest.raises(Fault, match="'angles'; run the rule angles"):
        Material({"bands": artifacts["bands"]}, CONFIG)
    with pytest.raises(Fault, match="'checks'; run the rule summarise"):
        Material({"angles": artifacts["angles"]}, CONFIG)


def test_one_trial_is_not_judged_by_what_needs_two():
    artifacts = make_artifacts(n_trial=1)
    scores = xr.Dataset({"refitted": ("trial", [False]), "pareto_k": ("trial", [2.1])})
    artifacts["posterior"]["leave_one_out"] = xr.DataTree(scores)
    material = gather(artifacts)
    checks = [find(list_computation(material), "Pareto"), *list_calibration(material)]
    assert {(check.found, check.passed) for check in checks} == {("needs two trials", None)}
    assert [tile.answer for tile in judge_tiles(material)[1:3]] == ["not judged", "not judged"]
    assert {check.found for check in list_fit(material)} == {"needs two trials"}
    assert "One trial cannot show" in build_spread(material).blocks[-1].text
    assert describe_causes(material) == []
    assert "1 trial shows nothing of the spread" in list_data_limits(material)[0]
