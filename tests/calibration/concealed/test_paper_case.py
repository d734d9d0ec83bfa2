"""The paper's own case: its wire moves the finger, its step solution leaves the moment arm out."""

import pytest

from softfinger.concealed.blind import diagnose_blind
from softfinger.concealed.generate import generate_campaign
from softfinger.concealed.judge import VISIBLE_NATS, judge
from softfinger.concealed.suite import build_paper_case

TRIALS = 20


@pytest.fixture(scope="module", params=["levels", "single_step"])
def case(request, tmp_path_factory):
    """Protocol, truth and answer."""
    folder = tmp_path_factory.mktemp("paper")
    spec = build_paper_case(request.param, TRIALS, 1)
    truth = generate_campaign(spec, folder / "0123456789", folder / "truth.json")
    return request.param, truth, diagnose_blind(folder / "0123456789", folder / "found", 1800.0)


@pytest.mark.slow
def test_the_residual_is_at_the_noise(case):
    _, truth, answer = case
    assert answer["reason"] is None
    assert truth["misfit"]["base"] / truth["misfit"]["true"] < 1.01
    rms = answer["verdict"]["residual_rms_rad"]
    assert rms["baseline"] == pytest.approx(rms["noise"], rel=0.05)


@pytest.mark.slow
def test_levels_name_the_moment_arm_and_a_step_says_what_the_oracle_allows(case):
    protocol, truth, answer = case
    verdict, judged = answer["verdict"], judge(answer["verdict"], truth)
    if protocol == "levels":
        assert truth["gain_nats"] >= VISIBLE_NATS
        assert judged.right, verdict["decision"]
    elif truth["gain_nats"] >= VISIBLE_NATS:
        assert verdict["decision"] in {"named", "ambiguous"}
        assert judged.contains
    else:
        assert verdict["decision"] == "adequate"
        assert "moment_arm" in verdict["not_testable"]
        assert verdict["next_experiment"]
