"""The paper's own case: its wire moves the finger, its step solution leaves the moment arm out."""

import pytest

from softfinger.concealed.blind import diagnose_blind
from softfinger.concealed.generate import generate_campaign
from softfinger.concealed.judge import VISIBLE_NATS, judge
from softfinger.concealed.suite import build_paper_case

TRIALS = 20


def _diagnose(protocol, folder):
    spec = build_paper_case(protocol, TRIALS, 1)
    truth = generate_campaign(spec, folder / "0123456789", folder / "truth.json")
    answer = diagnose_blind(folder / "0123456789", folder / "found", 1800.0)
    assert answer["reason"] is None
    return truth, answer["verdict"]


@pytest.mark.slow
def test_levels_name_the_moment_arm_although_the_residual_is_near_the_noise(tmp_path):
    truth, verdict = _diagnose("levels", tmp_path)
    rms = verdict["residual_rms_rad"]
    assert rms["noise"] < rms["baseline"] < 1.15 * rms["noise"]
    assert truth["gain_nats"] > 1000.0
    assert judge(verdict, truth).right
    scale = verdict["effects"][0]["parameters"]["arm_scale"]
    assert scale["mean"] == pytest.approx(1.0, abs=4.0 * scale["sd"])


@pytest.mark.slow
def test_a_single_step_says_what_the_oracle_allows(tmp_path):
    truth, verdict = _diagnose("single_step", tmp_path)
    assert truth["misfit"]["base"] < 1.01 * truth["misfit"]["true"]
    if truth["gain_nats"] >= VISIBLE_NATS:
        assert verdict["decision"] in {"named", "ambiguous"}
        assert judge(verdict, truth).contains
    else:
        assert verdict["decision"] == "adequate"
        assert "moment_arm" in verdict["not_testable"]
        assert verdict["next_experiment"]
