"""A concealed finger that is recorded again, by a process that gives recordings alone."""

import json
import subprocess
import sys

import numpy as np
import pytest

from softfinger.campaign import read_angle_table, read_campaign
from softfinger.concealed.again import read_loads, read_spec, record_again
from softfinger.concealed.suite import CaseSpec

SPEC = CaseSpec(5, ("strain_stiffening",), ((0, 1, 2),), (0.6,), "single_step", 4, "white")
STEPS = [
    {"time_s": [0.0, 1.0, 1.0, 12.0], "load": [0.0, 0.0, level, level]} for level in (2.0, 5.0)
]
PLAN = {"n_trials": 3, "duration_s": 12.0, "loads": STEPS}


@pytest.fixture(scope="module")
def plan(tmp_path_factory):
    place = tmp_path_factory.mktemp("again")
    (place / "plan.json").write_text(json.dumps(PLAN))
    sealed = {"case": SPEC.to_json(), "strengths": {"strain_stiffening": 1.0}}
    (place / "truth.json").write_text(json.dumps(sealed))
    return place / "plan.yaml"


def record(place, name, strength=1.0, number=1):
    loads, duration = read_loads(place.parent / "plan.yaml")
    folder = place.parent / name
    record_again(SPEC, {"strain_stiffening": strength}, loads, duration, number, folder)
    campaign = read_campaign(folder)
    return [read_angle_table(campaign, trial) for trial in campaign.trials]


def test_the_loads_are_those_of_the_plan_in_turn(plan):
    loads, duration = read_loads(plan)
    assert duration == 12.0
    assert [load.value(np.array([5.0]))[0] for load in loads] == [2.0, 5.0, 2.0]


def test_trials_are_new_and_repeat_with_their_round(plan):
    first, again, later = (
        record(plan, name, number=number) for name, number in (("a", 1), ("b", 1), ("c", 2))
    )
    assert len(first) == 3
    for one, same, other in zip(first, again, later, strict=True):
        np.testing.assert_array_equal(one.joint_angle, same.joint_angle)
        assert np.abs(one.joint_angle - other.joint_angle).max() > 0.01
    own = [float(table.joint_angle[:, -1].max()) for table in (first[0], first[2])]
    assert abs(own[0] - own[1]) > 0.001  # one load, two trials


def test_the_effect_is_there(plan):
    bent = [
        np.abs(record(plan, name, s)[1].joint_angle).max() for name, s in (("d", 0.0), ("e", 3.0))
    ]
    assert bent[1] < 0.95 * bent[0]


def test_the_rig_leaves_recordings_and_nothing_else(plan):
    out = plan.parent / "recorded"
    words = [sys.executable, "-m", "softfinger.concealed.again", plan.parent / "truth.json"]
    subprocess.run([str(word) for word in (*words, plan, out, 1)], check=True)
    assert {path.name for path in out.iterdir()} == {
        "campaign.yaml",
        "trials.csv",
        "angles",
        "load",
    }
    assert not any("stiffening" in p.read_text() for p in out.rglob("*") if p.is_file())


def test_a_case_returns_from_json():
    assert read_spec(json.loads(json.dumps(SPEC.to_json()))) == SPEC
