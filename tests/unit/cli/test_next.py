"""`softfinger next`: a plan from a folder of results, and what it refuses."""

import csv
import json
from pathlib import Path

import numpy as np
import pytest

from softfinger.artifacts import open_artifact
from softfinger.artifacts.specs import angles as angles_spec
from softfinger.artifacts.verdict import Verdict, write_verdict
from softfinger.config import read_config
from softfinger.mechanics.effects.model_file import FittedTo, ModelFile
from softfinger.mismatch.experiment.survivors import OpenModel, OpenModels, write_survivors
from softfinger.provenance import hash_files
from softfinger.rig.plan import build_schedule, read_plan
from softfinger.stages.prepare import prepare_angles

EXAMPLE = Path(__file__).parents[3] / "data/example"
RIG = Path(__file__).parents[3] / "docs/rig/plan.yaml"


def build_verdict(campaign):
    nothing = {
        "location": None, "elpd": None, "free_form": None, "next_experiment": None,
        "explained_spread": {}, "not_testable": [], "set_aside": [], "n_trials": 4, "effects": [],
        "residual_rms_rad": {"baseline": 0.003, "final": 0.003, "noise": 0.003},
    }  # fmt: skip
    left = [["actuator_lag"], ["camera_delay"]]
    return Verdict(campaign=campaign, decision="ambiguous", equivalent=left, **nothing)


@pytest.fixture(scope="module")
def results(tmp_path_factory):
    """A diagnosis that leaves lag and delay open, of the example."""
    out = tmp_path_factory.mktemp("next") / "results"
    file = prepare_angles(EXAMPLE, out, read_config(None))
    angles = open_artifact(file, angles_spec.SPEC)
    fitted = FittedTo(campaign=str(angles.attrs["campaign"]), sha256=hash_files(file))

    def model(identity, form):
        effect = {"id": identity, "form": form, "joints": []}
        effects = [effect | {"priors": {}}]
        content = {"version": 1, "joint": "three_element", "torque": "constant_arm"}
        return ModelFile.model_validate(content | {"effects": effects, "fitted_to": fitted})

    listed = [
        OpenModel(effects=name, probability=0.5, model=model(name, form))
        for name, form in (("actuator_lag", "first_order"), ("camera_delay", "constant"))
    ]
    content = OpenModels(version=1, fitted_to=fitted, decision="ambiguous", survivors=listed)
    write_survivors(content, out / "survivors.yaml")
    write_verdict(build_verdict(fitted.campaign), out / "verdict.json")
    return out


def test_a_plan_runs_on_the_rig_and_on_others(call, results, tmp_path):
    file = tmp_path / "plan.yaml"
    limits = ("--trials", 4, "--max-load", 8, "--max-angle", 2.5, "--minutes", 2.4, "--rest-s", 30)
    done = call("next", results, *limits, "--rig", RIG, "--out", file, "--json")
    assert done.status == 0, done.stderr
    said = json.loads(done.stdout)
    plan = read_plan(file)
    assert len(build_schedule(plan)) == 4
    assert said["runs_on_rig"]
    for profile in plan.profiles:
        time, tension = profile.build_knots()
        assert tension.max() <= 8.0
        assert time[-1] == pytest.approx(said["duration_s"], abs=1e-3)
    with Path(said["load_files"][0]).open() as stream:
        rows = [float(row["tension_n"]) for row in csv.DictReader(stream)]
    assert 0.0 < max(rows) <= 8.0
    assert said["largest_angle_rad"] <= 2.5
    assert file.with_suffix(".png").read_bytes()[:4] == b"\x89PNG"
    assert np.isfinite(said["probability_sure"])
    assert "actuator_lag" in said["statement"]


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("--max-load", 20, "--rig", RIG), "safety.tension_limit_n"),
        (("--fps", 200, "--rig", RIG), "camera of"),
    ],
)
def test_what_a_rig_cannot_run_is_refused(call, results, tmp_path, arguments, words):
    done = call("next", results, *arguments, "--out", tmp_path / "plan.yaml")
    assert done.status == 1
    assert words in done.stderr
    assert "Traceback" not in done.stderr


def test_a_folder_without_a_diagnosis_or_of_two_campaigns_is_refused(call, results, tmp_path):
    done = call("next", tmp_path, "--out", tmp_path / "plan.yaml")
    assert done.status == 1
    assert "it has no verdict.json" in done.stderr
    for name in ("angles.nc", "survivors.yaml"):
        (tmp_path / name).write_bytes((results / name).read_bytes())
    write_verdict(build_verdict("another"), tmp_path / "verdict.json")
    done = call("next", tmp_path, "--out", tmp_path / "plan.yaml")
    assert done.status == 1
    assert "it is of campaign 'another'" in done.stderr
