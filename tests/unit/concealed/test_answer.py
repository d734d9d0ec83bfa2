"""A concealed finger records a plan: its loads, its own physics, trials of their own."""

import json

import numpy as np
import pandas as pd
import pytest
from ruamel.yaml import YAML

from softfinger.concealed.answer import _date, answer_plan
from softfinger.concealed.suite import CaseSpec


@pytest.fixture(scope="module")
def truth(tmp_path_factory):
    """What is known of a clean case; nothing was placed, so no oracle is needed."""
    file = tmp_path_factory.mktemp("truth") / "truth.json"
    spec = CaseSpec(5, (), (), (), "single_step", 4, "white")
    file.write_text(json.dumps({"case": spec.to_json(), "effects": []}))
    return file


@pytest.fixture(scope="module")
def plan(tmp_path_factory):
    file = tmp_path_factory.mktemp("plan") / "plan.yaml"
    path = {"name": "next", "shape": "path", "time_s": [0, 3, 3, 6], "tension_n": [5, 5, 1, 1]}
    content = {"profiles": [path], "recording": {"repeats": 2, "rest_s": 30.0}}
    YAML().dump(content, file)
    return file


def test_a_plan_is_recorded_as_asked_and_rounds_differ(truth, plan, tmp_path):
    for number in (1, 2):
        answer_plan(truth, plan, tmp_path / f"round_{number}", number)
    table = pd.read_csv(tmp_path / "round_1/trials.csv")
    assert len(table) == 2
    load = pd.read_csv(tmp_path / "round_1/load/trial_001.csv")
    np.testing.assert_allclose(np.interp([1.0, 5.0], load["time_s"], load["tension_n"]), [5, 1])
    first, other = (
        pd.read_csv(tmp_path / f"round_{k}/angles/trial_001.csv")["q1_rad"] for k in (1, 2)
    )
    assert first.max() > 0.05
    assert not np.allclose(first[:50], other[:50], atol=1e-3)
    assert sorted(p.name for p in (tmp_path / "round_1").iterdir()) == [
        "angles", "campaign.yaml", "load", "trials.csv",
    ]  # fmt: skip


def test_rounds_are_dated_a_day_apart_with_and_without_fractions_of_seconds(tmp_path):
    """A rest of half seconds gave moments of two layouts."""
    table = tmp_path / "trials.csv"
    table.write_text("trial,started_at\na,2024-03-04T09:00:00\nb,2024-03-04T09:01:11.500000\n")
    _date(table, 2)
    assert pd.read_csv(table)["started_at"].tolist() == [
        "2024-03-06T09:00:00", "2024-03-06T09:01:11.500000",
    ]  # fmt: skip
