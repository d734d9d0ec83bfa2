"""Scoring, on verdicts and truths written by hand."""

import copy

import numpy as np
import pytest

from softfinger.concealed.effects import CATALOGUES
from softfinger.concealed.judge import judge
from softfinger.concealed.score import (
    collect_benchmarks,
    compute_share,
    score,
    shuffle_truths,
)


def _truth(*effects, gain=40.0, misfit=1.2, elpd=50.0):
    return {
        "case": {"quantiles": [0.5] * len(effects)},
        "effects": [
            {
                "id": name,
                "listed": name in CATALOGUES["first"],
                "level": "within_trial",
                "covariate": None,
                "joints": [2],
                "parameters": {"lag_s": 0.05} if name == "actuator_lag" else {},
                "gain_nats": own,
            }
            for name, own in effects
        ],
        "gain_nats": gain if effects else 0.0,
        "elpd_difference": elpd if effects else 0.0,
        "values": 20_000,
        "misfit": {"base": misfit, "true": 1.0},
        "window_s": [0.1, 1.1] if effects else None,
        "population": {"mean": [[0.0] * 3] * 4},
    }


def _verdict(decision, *effects, equivalent=(), probability=0.99, elpd=45.0):
    location = {
        "level": "within_trial",
        "joints": {"1": 0.4, "2": 1e-6, "3": 0.9},
        "times_s": [0.0, 0.9],
        "trials": None,
        "covariate": None,
    }
    return {
        "decision": decision,
        "effects": [
            {"id": name, "joints": [2], "probability": probability, "parameters": {}}
            for name in effects
        ],
        "equivalent": [list(group) for group in equivalent],
        "location": None if decision == "adequate" else location,
        "elpd": {"baseline": 0.0, "final": elpd, "difference": elpd, "se": 3.0},
    }


LAG = _truth(("actuator_lag", 40.0))


def test_the_right_name_is_right():
    found = judge(_verdict("named", "actuator_lag"), LAG)
    assert found.right
    assert found.contains
    assert found.visible
    assert (found.truth, found.answer) == ("actuator_lag", "actuator_lag")
    assert found.joints
    assert found.level
    assert found.window
    assert found.covariate is None
    assert found.gap_closed == pytest.approx(0.9)


@pytest.mark.parametrize(
    "verdict",
    [
        _verdict("named", "inertia"),
        _verdict("named", "actuator_lag", "inertia"),
        _verdict("adequate"),
        _verdict("unlisted"),
        _verdict("unlisted", "actuator_lag"),
        _verdict("ambiguous", "actuator_lag", "inertia", equivalent=[["actuator_lag", "inertia"]]),
    ],
)
def test_any_other_answer_is_not(verdict):
    assert not judge(verdict, LAG).right


def test_a_clean_campaign_is_adequate():
    clean = _truth()
    assert judge(_verdict("adequate"), clean).right
    alarm = judge(_verdict("named", "gravity"), clean)
    assert not alarm.right
    assert alarm.stated == [(0.99, False)]
    assert not alarm.visible


def test_an_effect_from_outside_is_unlisted():
    outside = _truth(("tension_ripple", 80.0))
    assert judge(_verdict("unlisted"), outside).right
    assert not judge(_verdict("named", "gravity"), outside).right
    assert judge(_verdict("unlisted"), outside).truth == "outside"


def test_of_two_effects_only_the_visible_one_must_be_named():
    both = _truth(("gravity", 40.0), ("inertia", 2.0))
    for names in (("gravity",), ("gravity", "inertia")):
        assert judge(_verdict("named", *names), both).right
    assert not judge(_verdict("named", "inertia"), both).right
    strong = _truth(("gravity", 40.0), ("inertia", 20.0))
    assert not judge(_verdict("named", "gravity"), strong).right


def test_two_that_only_show_together_need_one_name_at_least():
    tied = _truth(("actuator_lag", 3.0), ("camera_delay", 3.0))
    assert judge(_verdict("named", "camera_delay"), tied).right
    assert not judge(_verdict("adequate"), tied).right


@pytest.mark.parametrize(
    ("equivalent", "contains"),
    [
        ([["camera_delay", "actuator_lag"]], True),
        ([["camera_delay", "inertia"]], False),
        ([["camera_delay+actuator_lag", "inertia"]], False),
        ([["camera_delay", "actuator_lag"], ["gravity", "moment_arm"]], False),
    ],
)
def test_a_set_contains_the_truth_or_not(equivalent, contains):
    ids = [name for group in equivalent for member in group for name in member.split("+")]
    found = judge(_verdict("ambiguous", *ids, equivalent=equivalent), LAG)
    assert found.contains is contains


def test_a_set_with_a_sure_member_contains_a_pair():
    pair = _truth(("gravity", 400.0), ("actuator_lag", 40.0))
    groups = [["camera_delay", "actuator_lag"]]
    verdict = _verdict("ambiguous", "gravity", "camera_delay", "actuator_lag", equivalent=groups)
    assert judge(verdict, pair).contains
    groups = [["gravity+camera_delay", "gravity+actuator_lag"]]
    verdict = _verdict("ambiguous", "gravity", "camera_delay", "actuator_lag", equivalent=groups)
    assert judge(verdict, pair).contains


def test_masked_is_visible_to_the_oracle_but_not_in_the_residual():
    assert not judge(_verdict("adequate"), LAG).masked
    assert judge(_verdict("adequate"), _truth(("gravity", 40.0), misfit=1.01)).masked
    buried = _truth(("gravity", 4.0), gain=4.0, misfit=1.01)
    assert not judge(_verdict("adequate"), buried).masked
    assert judge(_verdict("adequate"), buried).contains


def test_a_set_with_none_contains_what_is_buried_but_not_what_is_visible():
    verdict = _verdict("ambiguous", "inertia", equivalent=[["none", "inertia"]])
    assert judge(verdict, _truth(("gravity", 4.0), gain=4.0)).contains
    assert not judge(verdict, LAG).contains
    assert not judge(verdict, _truth()).right


def test_a_wrong_place_is_seen():
    verdict = _verdict("named", "actuator_lag")
    verdict["effects"][0]["joints"] = [1]
    verdict["location"]["level"] = "measurement"
    verdict["location"]["times_s"] = [1.0, 9.0]
    found = judge(verdict, LAG)
    assert (found.joints, found.level, found.window) == (False, False, False)


def test_an_effect_on_the_whole_chain_may_be_said_with_or_without_its_joints():
    chain = copy.deepcopy(LAG)
    chain["effects"][0]["joints"] = []
    verdict = _verdict("named", "actuator_lag")
    for joints, right in (([], True), ([1, 2, 3], True), ([2], False)):
        verdict["effects"][0]["joints"] = joints
        assert judge(verdict, chain).joints is right


def test_the_covariate_of_a_drift_counts():
    drift = _truth(("fatigue_softening", 40.0))
    drift["effects"][0] |= {"level": "between_trials", "covariate": "trial_number"}
    verdict = _verdict("named", "fatigue_softening")
    assert judge(verdict, drift).covariate is False
    verdict["location"]["covariate"] = "trial_number"
    assert judge(verdict, drift).covariate is True


@pytest.mark.parametrize(("bounds", "covered"), [((0.04, 0.06), True), ((0.051, 0.06), False)])
def test_intervals_cover_or_not(bounds, covered):
    verdict = _verdict("named", "actuator_lag")
    verdict["effects"][0]["parameters"] = {
        "lag_s": {"mean": 0.05, "sd": 0.01, "q05": bounds[0], "q95": bounds[1]},
        "unknown": {"mean": 0.0, "sd": 1.0, "q05": -1.0, "q95": 1.0},
    }
    assert judge(verdict, LAG).covered == {"lag_s": covered}


@pytest.fixture
def suite():
    """Ten clean ones with one alarm, twelve lags of which nine are named, four from outside."""
    truths = [_truth() for _ in range(10)]
    verdicts = [_verdict("named", "gravity"), *[_verdict("adequate") for _ in range(9)]]
    gains = np.geomspace(2.0, 2000.0, 12)
    truths += [_truth(("actuator_lag", gain), gain=gain, elpd=gain) for gain in gains]
    verdicts += [_verdict("adequate") for _ in range(3)]
    verdicts += [_verdict("named", "actuator_lag", elpd=0.8 * gain) for gain in gains[3:]]
    truths += [_truth(("joint_play", 50.0)) for _ in range(4)]
    verdicts += [_verdict("unlisted") for _ in range(3)] + [_verdict("named", "gravity")]
    return verdicts, truths


def test_the_score_counts_every_case_once(suite):
    scored = score(*suite, seconds=np.arange(26.0))
    assert scored.sizes["case"] == 26
    confusion = scored.confusion
    assert int(confusion.sum()) == 26
    assert int(confusion.sel(truth="clean", answer="adequate")) == 9
    assert int(confusion.sel(truth="actuator_lag", answer="actuator_lag")) == 9
    assert int(confusion.sel(truth="outside", answer="gravity")) == 1
    share = scored.share.to_series()
    assert share["false_alarm"] == pytest.approx(0.1)
    assert share["named"] == pytest.approx(1.0)  # the three that were missed are below 15 nats
    assert share["unlisted"] == pytest.approx(0.75)
    assert share["location_joints"] == pytest.approx(1.0)
    assert np.isnan(share["interval_coverage_90"])
    assert int(scored.share_count.sel(statistic="named")) == 8
    assert float(scored.seconds.max()) == 25.0


def test_the_curve_follows_the_evidence(suite):
    scored = score(*suite)
    curve = scored.right_by_gain.dropna("gain_bin")
    assert float(curve[0]) == 0.0
    assert float(curve[-1]) == 1.0
    assert int(scored.count_by_gain.sum()) == 12
    could = scored.could_by_gain.dropna("gain_bin")
    assert float(could[0]) < 0.5 < float(could[-1]) <= 1.0


def test_stated_probabilities_meet_what_was_true(suite):
    scored = score(*suite)
    told = scored.sel(probability_bin=0.99)
    assert int(told.stated_count) == 11  # nine right, an alarm, one wrong name for joint play
    assert float(told.stated_probability) == pytest.approx(0.99)
    assert float(told.true_share) == pytest.approx(9 / 11)


def test_benchmark_keys_hold_only_what_was_measured(suite):
    keys = collect_benchmarks(score(*suite))
    assert keys["concealed_named_share"] == 1.0
    assert keys["concealed_false_alarm_share"] == pytest.approx(0.1)
    assert keys["concealed_gap_closed_median"] == pytest.approx(0.8)
    assert "concealed_interval_coverage_90" not in keys


def test_nothing_to_score_gives_nothing():
    scored = score([], [])
    assert collect_benchmarks(scored) == {}
    assert int(scored.confusion.sum()) == 0


def test_shuffled_answers_fall_to_chance():
    names = list(CATALOGUES["first"][:10])
    truths = [_truth((name, 100.0), gain=100.0) for name in names for _ in range(3)]
    verdicts = [_verdict("named", name) for name in names for _ in range(3)]
    assert float(score(verdicts, truths).share.sel(statistic="named")) == 1.0
    chance = shuffle_truths(verdicts, truths, np.random.default_rng(5))
    assert chance == pytest.approx(0.1, abs=0.02)


def test_shares_have_binomial_intervals():
    share, lower, upper = compute_share(95, 100)
    assert share == 0.95
    assert (lower, upper) == (pytest.approx(0.8872, abs=1e-4), pytest.approx(0.9836, abs=1e-4))
    assert compute_share(5, 5)[2] == 1.0
    assert np.isnan(compute_share(0, 0)).all()
