import json

import pytest
from pydantic import ValidationError

from softfinger.artifacts.verdict import (
    Location,
    ResidualRms,
    StatedEffect,
    Verdict,
    estimate_normal,
    read_verdict,
    write_verdict,
)
from softfinger.faults import ArtifactFault

LOCATION = Location(
    level="within_trial", joints={"1": 0.4, "2": 1e-12}, times_s=(1.2, 18.0), trials=None,
    covariate=None,
)  # fmt: skip


def build(**changes):
    content = {
        "campaign": "a rig",
        "decision": "named",
        "effects": [
            StatedEffect(
                id="second_retardation",
                joints=[2],
                probability=0.98,
                parameters={"retardation_time_s": estimate_normal(5.9, 0.4)},
                statement="Joint 2 keeps relaxing.",
                location=LOCATION,
            )
        ],
        "equivalent": [["second_retardation"]],
        "location": LOCATION,
        "elpd": None,
        "residual_rms_rad": ResidualRms(baseline=0.0065, final=0.003, noise=0.003),
        "explained_spread": {"log_k_v": {"1": 0.62}},
        "not_testable": ["yield_threshold"],
        "free_form": None,
        "n_trials": 40,
        "set_aside": [{"trial": "trial_007", "reason": "truncated"}],
        "next_experiment": None,
    }
    return Verdict(**{**content, **changes})


def test_a_verdict_returns_from_its_file(tmp_path):
    verdict = build()
    write_verdict(verdict, tmp_path / "verdict.json")
    assert read_verdict(tmp_path / "verdict.json") == verdict
    content = json.loads((tmp_path / "verdict.json").read_text())
    assert content["version"] == 1
    assert content["effects"][0]["parameters"]["retardation_time_s"]["mean"] == 5.9
    assert content["location"]["times_s"] == [1.2, 18.0]


@pytest.mark.parametrize(
    "changes",
    [
        {"decision": "adequate"},
        {"decision": "named", "effects": []},
        {"decision": "ambiguous", "equivalent": []},
        {"residual_rms_rad": {"baseline": float("nan"), "final": 1.0, "noise": 1.0}},
        {"decision": "perhaps"},
    ],
)
def test_contradictions_are_refused(changes):
    with pytest.raises(ValidationError):
        build(**changes)


def test_every_fault_of_a_file_is_listed(tmp_path):
    path = tmp_path / "verdict.json"
    write_verdict(build(), path)
    content = json.loads(path.read_text())
    del content["campaign"]
    content["n_trials"] = "many"
    path.write_text(json.dumps(content))
    with pytest.raises(ArtifactFault, match=r"campaign(.|\n)*n_trials"):
        read_verdict(path)
    with pytest.raises(ArtifactFault, match="No such file"):
        read_verdict(tmp_path / "absent.json")
