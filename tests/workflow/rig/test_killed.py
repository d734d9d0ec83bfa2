"""`rig record` is killed at random moments: every finished trial is kept, the next call goes on."""

import csv
import time

import numpy as np
import pytest
from ruamel.yaml import YAML
from tests.workflow.killing import SIGNALS, kill, start

from softfinger.campaign import check_campaign

KILLS = 8
TRIALS = 6
LONGEST_S = 25.0


@pytest.fixture
def six_trials(plan_file, tmp_path):
    plan = YAML(typ="safe").load(plan_file)
    plan["recording"]["repeats"] = TRIALS // 2
    YAML().dump(plan, tmp_path / "six.yaml")
    return tmp_path / "six.yaml"


def list_trials(folder):
    table = folder / "trials.csv"
    return list(csv.DictReader(table.read_text().splitlines())) if table.exists() else []


def read_finished(folder):
    """Files of the trials that are in the table: name → bytes."""
    return {
        row[column]: (folder / row[column]).read_bytes()
        for row in list_trials(folder)
        for column in ("video", "load")
    }


@pytest.mark.slow
def test_a_killed_session_keeps_its_trials_and_goes_on(calm_rig, six_trials, tmp_path):
    rig, folder, rng = calm_rig, tmp_path / "campaign", np.random.default_rng(9)
    options = [six_trials, "--out", folder, "--port", rig.port, "--camera", rig.camera]
    kept = {}
    for number in range(KILLS):
        since = len(rig.read_transcript())
        recorder = start(tmp_path, "rig", "record", *options)
        time.sleep(rng.uniform(1.0, LONGEST_S))
        kill(recorder, SIGNALS[number % len(SIGNALS)], tmp_path)
        if any(" start*" in line for line in rig.read_transcript()[since:]):
            rig.wait_for("name=released", since)
        finished = read_finished(folder)
        assert kept.items() <= finished.items()
        kept = finished
    recorder = start(tmp_path, "rig", "record", *options)
    assert recorder.wait() == 0, (tmp_path / "said.txt").read_text()
    finished = read_finished(folder)
    assert kept.items() <= finished.items()
    assert len(list_trials(folder)) == TRIALS
    assert check_campaign(folder) == {}
    assert not list(folder.rglob(".unfinished-*"))
