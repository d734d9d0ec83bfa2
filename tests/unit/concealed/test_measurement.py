"""Unkind recordings scored, on verdicts and truths written by hand."""

import pytest

from softfinger.concealed.measurement import (
    check_findings,
    collect_measurement,
    describe_condition,
    is_alarm,
    list_alarms,
    pair_twins,
)


def _fault(name, nats=40.0, finding=None, also=()):
    return {
        "id": name,
        "finding": name if finding is None else finding,
        "also": list(also),
        "nats": nats,
    }


def _truth(*faults, effect=None, gain=40.0, seed=1, noise=()):
    effects = [{"id": effect, "listed": True, "gain_nats": gain, "parameters": {}}]
    return {
        "case": {"seed": seed, "nuisances": [fault["id"] for fault in faults], "quantiles": []},
        "faults": list(faults),
        "effects": effects if effect else [],
        "gain_nats": gain if effect else 0.0,
        "elpd_difference": None,
        "values": 20_000,
        "misfit": {"base": 1.2, "true": 1.0},
        "window_s": None,
        "population": {"mean": [[0.0] * 3] * 4},
        "noise": {"findings": list(noise)},
    }


def _verdict(decision, *effects, equivalent=(), measurement=None):
    verdict = {
        "decision": decision,
        "effects": [{"id": n, "joints": [], "probability": 1.0, "parameters": {}} for n in effects],
        "equivalent": [list(group) for group in equivalent],
        "location": None,
        "elpd": None,
    }
    if measurement is not None:
        verdict["measurement"] = [{"id": name} for name in measurement]
    return verdict


@pytest.mark.parametrize(
    ("verdict", "alarm"),
    [
        (_verdict("adequate"), False),
        (_verdict("named", "gravity"), True),
        (_verdict("unlisted"), True),
        (_verdict("crashed"), True),
        (_verdict("ambiguous", equivalent=[["none", "gravity"]]), False),
        (_verdict("ambiguous", equivalent=[["inertia", "gravity"]]), True),
    ],
)
def test_what_counts_as_an_alarm(verdict, alarm):
    assert is_alarm(verdict) is alarm


def test_alarms_are_counted_by_condition_on_clean_campaigns_alone():
    cases = [
        (_verdict("adequate"), _truth()),
        (_verdict("unlisted"), _truth(_fault("hum"))),
        (_verdict("adequate"), _truth(_fault("hum"))),
        (_verdict("adequate"), _truth(_fault("hum"), _fault("outliers"))),
        (_verdict("unlisted"), _truth(_fault("outliers"), effect="gravity")),
    ]
    assert list_alarms(cases) == [
        ("none", False),
        ("hum", True),
        ("hum", False),
        ("several", False),
    ]
    found = collect_measurement(cases)
    assert found["clean_false_alarm_share"] == pytest.approx(0.25)
    assert found["clean_false_alarm_share_worst_condition"] == pytest.approx(0.5)
    assert found["clean_campaigns"] == 4
    assert "nuisance_named_share_loss" not in found
    assert "measurement_named_share" not in found


def test_one_condition_alone_gives_no_share_over_conditions():
    assert collect_measurement([(_verdict("adequate"), _truth())]) == {}


def test_names_lost_are_counted_over_pairs_visible_in_both():
    named, missed = _verdict("named", "gravity"), _verdict("unlisted")
    fault = _fault("hum")
    cases = []
    for seed, (answer, gain) in enumerate([(named, 40.0), (missed, 40.0), (missed, 9.0)]):
        cases.append((named, _truth(effect="gravity", seed=seed)))
        cases.append((answer, _truth(fault, effect="gravity", gain=gain, seed=seed)))
    cases.append((named, _truth(effect="gravity", seed=99)))  # a single campaign
    assert sorted(pair_twins(cases)) == [(True, False), (True, True)]
    assert collect_measurement(cases)["nuisance_named_share_loss"] == pytest.approx(0.5)


def test_a_visible_fault_must_be_found_and_others_are_false():
    seen = _truth(
        _fault("noisy_load"), _fault("hum", finding="", also=["drift"]), noise=["lost_frames"]
    )
    stated = ["noisy_load", "drift", "lost_frames", "outliers"]
    found, false = check_findings([(_verdict("adequate", measurement=stated), seen)])
    assert found == [True]
    assert false == [False, False, False, True]
    faint = _truth(_fault("noisy_load", nats=14.9))
    assert check_findings([(_verdict("adequate", measurement=[]), faint)]) == ([], [])
    plain = _truth(_fault("noisy_load", nats=15.0))
    assert check_findings([(_verdict("adequate", measurement=[]), plain)]) == ([False], [])


def test_a_verdict_without_findings_is_not_asked():
    assert check_findings([(_verdict("adequate"), _truth(_fault("outliers")))]) == ([], [])


def test_a_condition_has_a_name():
    assert describe_condition(_truth()) == "none"
    assert describe_condition(_truth(_fault("hum"))) == "hum"
    assert describe_condition(_truth(_fault("hum"), _fault("outliers"))) == "several"
