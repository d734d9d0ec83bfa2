"""The proof of the loop: what its rivals ask, and how it counts."""

import json

import numpy as np
import pytest
from benchmarks import loop

from softfinger.concealed.answer import read_loads


@pytest.fixture
def campaign(tmp_path):
    (tmp_path / "load").mkdir()
    for k in range(12):
        rows = [[0.0, 0.0], [1.0, 0.0], [1.00001, 7.0 - 0.1 * k]]
        np.savetxt(tmp_path / f"load/trial_{k:03d}.csv", rows, delimiter=",", header="t,n")
    return tmp_path


@pytest.mark.parametrize("name", ["again", "staircase", "random"])
def test_rivals_ask_for_as_many_trials_and_no_larger_load(campaign, name):
    loop.PLANNERS[name](campaign, campaign, campaign / "plan.yaml", 1)
    loads, _ = read_loads(campaign / "plan.yaml")
    assert len(loads) == loop.TRIALS
    for load in loads:
        assert 0.0 <= load.tension.min() <= load.tension.max() <= 7.0
        assert np.all(np.diff(load.time) >= 0.0)
        assert load.time[-1] == loop.DURATION_S
    if name == "again":
        assert loads[3].tension.max() == pytest.approx(6.7)


def test_every_effect_takes_its_turn():
    drawn = [spec.effects[0] for spec in loop.draw_cases(3, 20)]
    assert len(set(drawn)) == 20


def test_an_answer_that_never_came_counts_a_round_more():
    assert loop._count({"sure": True, "trials": 10}) == 10
    assert loop._count({"sure": False, "trials": 20}) == 30


def test_what_was_foreseen_is_scored_against_its_mean():
    found = loop._calibrate([(1.0, True), (0.0, False), (1.0, True)])
    assert found["loop_brier"] == 0.0
    assert found["loop_brier_of_the_mean"] == pytest.approx(2 / 9)
    assert loop._calibrate([]) == {}


def test_a_case_that_no_oracle_sees_is_left_out(tmp_path):
    (tmp_path / "truth.json").write_text(json.dumps({"visible_nats": 3.0}))
    assert loop.tell_case(tmp_path, "ours") is None
