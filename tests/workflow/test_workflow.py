"""The workflow as a whole: its product, its artifacts, what reruns and what does not."""

import csv
import os
import re
from pathlib import Path

import numpy as np
import pytest

from softfinger.artifacts import open_artifact, open_tree
from softfinger.artifacts.specs import angles as angles_spec
from softfinger.artifacts.specs import list_specs
from softfinger.concealed.generate import write_recordings
from softfinger.concealed.suite import CaseSpec

PROJECT = Path(__file__).parents[2]
SUMMED = {"summarise", "report", "check_artifacts", "all"}
PROPAGATED = {"propagate", "sobol", "shapley", *SUMMED}
FITTED = {"sampling", *PROPAGATED}
FILMED = {"virtual_rig", "film", "track", "angles", "doubt", "picture", "tracking_quality"}
MEASURED = {"least_squares", "diagnose", "fit", *FITTED}
SPECS = {spec.name: spec for spec in list_specs()}


def planned_rules(said: str) -> set[str]:
    """Rules in the table of jobs that a dry run prints."""
    table = said.split("Job stats:")[1].split("total")[0]
    found = re.findall(r"^([a-z]\w+) +\d+$", table, re.MULTILINE)
    return {re.sub(r"_\d{4}$", "", name) for name in found} - {"job"}


def test_every_artifact_keeps_its_declaration(finished):
    results = finished.root / "results"
    for path in [*results.glob("*.nc"), *(results / "markers").glob("*.nc")]:
        spec = SPECS["markers" if path.parent.name == "markers" else path.stem]
        (open_tree if spec.groups else open_artifact)(path, spec)


def test_no_result_contains_a_path_of_this_machine(finished):
    results = finished.root / "results"
    kinds = {".nc", ".json", ".yaml", ".csv", ".html", ".svg", ".txt"}
    files = [path for path in results.rglob("*") if path.suffix in kinds]
    assert len(files) >= 20
    for path in files:
        if "logs" not in path.parts:
            content = path.read_bytes()
            for folder in (finished.root, PROJECT, Path.home()):
                assert f"{folder}/".encode() not in content, path


@pytest.mark.slow
def test_a_clock_that_jumped_between_two_runs_changes_no_result(finished):
    """Files of the future and of the past: what reruns ends with the same bytes."""
    results = finished.root / "results"
    artifacts = sorted(results.glob("*.nc"))
    before = {path: path.read_bytes() for path in artifacts}
    rng = np.random.default_rng(3)
    for path in artifacts:
        moment = path.stat().st_mtime + rng.uniform(-86400.0, 86400.0)
        os.utime(path, (moment, moment))
    finished.snakemake("all", "--cores", "2")
    assert {path: path.read_bytes() for path in artifacts} == before
    assert "Nothing to be done" in finished.snakemake("all", "--cores", "2", "--dry-run")


def test_the_run_ends_in_a_report_and_a_receipt(finished):
    results = finished.root / "results"
    page = (results / "report.html").read_text()
    assert "synthetic" in page
    first = page[page.index("<body>") : page.index('<div class="referee">')]
    first = re.sub("<nav.*?</nav>", "", first, flags=re.DOTALL)
    assert 200 < len(re.sub("<[^>]+>", " ", first).split()) <= 900
    assert 3 <= first.count("<figure") <= 5
    assert "http://" not in re.sub(r"http://www\.w3\.org[^\"' ]*", "", page)
    rows = list(csv.DictReader((results / "receipt.csv").read_text().splitlines()))
    assert {row["artifact"] for row in rows} >= {"angles", "markers", "posterior", "sobol"}


def test_tracked_angles_are_the_true_ones_within_their_noise(finished):
    results = finished.root / "results"
    found = open_artifact(results / "angles.nc", SPECS["angles"])
    truth = open_artifact(results / "truth.nc", SPECS["truth"])
    error = found["joint_angle"].to_numpy() - truth["joint_angle"].to_numpy()
    claimed = np.sqrt(np.einsum("tfjj->tjf", found["joint_angle_covariance"].to_numpy()))
    assert found["set_aside_reason"].size == 0
    assert np.isfinite(error).mean() > 0.99
    assert np.sqrt(np.nanmean((error / claimed) ** 2)) < 1.5
    assert np.sqrt(np.nanmean(error**2)) < 1e-3


def test_nothing_reruns_when_nothing_has_changed(finished):
    said = finished.snakemake("all", "--cores", "2", "--dry-run")
    assert "Nothing to be done" in said


EDITS = {
    "propagation/design.py": {"sobol", "shapley", *SUMMED},
    "report/page.py": {"report", "all"},
    "inference/collapse/basis.py": {"least_squares", "propagate", "sobol", *SUMMED},
    "inference/expansion.py": {"fit", "diagnose", *FITTED},
    "mismatch/search/stepwise.py": {"diagnose", *SUMMED},
    "mechanics/effects/wire_friction.py": FILMED | MEASURED,
}


@pytest.mark.parametrize(("module", "rules"), list(EDITS.items()))
def test_an_edit_of_library_code_reruns_what_depends_on_it_and_no_other(editable, module, rules):
    path = editable.root / "src/softfinger" / module
    path.write_text(path.read_text() + "\nREVISION = 2\n")
    assert planned_rules(editable.snakemake("all", "--cores", "2", "--dry-run")) == rules


def test_a_remark_in_library_code_reruns_nothing(editable):
    for module in EDITS:
        with (editable.root / "src/softfinger" / module).open("a") as file:
            file.write("\n# a remark\n")
    assert "Nothing to be done" in editable.snakemake("all", "--cores", "2", "--dry-run")


@pytest.mark.parametrize(
    ("setting", "rules"),
    [
        ("estimation: {cores: 1}", {"report", "all"}),  # it shows the whole configuration
        ("estimation: {r_hat_max: 1.02}", {"diagnose", "sampling", *SUMMED}),
        ("estimation: {outlier_cutoff: 2.5}", {"least_squares", *PROPAGATED} - {"shapley"}),
        ("mismatch: {bootstrap_replicates: 199}", {"diagnose", *SUMMED}),
    ],
)
def test_a_setting_reruns_the_rules_that_read_it_and_no_other(finished, setting, rules):
    (finished.root / "setting.yaml").write_text(setting)
    said = finished.snakemake("all", "--cores", "2", "--dry-run", settings=("setting.yaml",))
    assert planned_rules(said) == rules


def test_the_same_seed_gives_the_same_bytes_on_one_core_and_on_two(finished):
    wanted = ("again/sampling.nc", "again/sobol.nc", "again/bands.nc")
    finished.snakemake(*wanted, "--cores", "2", "--config", "out=again")
    for name in ("truth", "angles", "least_squares", "posterior", "sampling", "bands", "sobol"):
        one, two = (finished.root / folder / f"{name}.nc" for folder in ("results", "again"))
        assert one.read_bytes() == two.read_bytes(), name


def test_an_unknown_key_of_the_configuration_stops_before_any_work(finished):
    with pytest.raises(AssertionError, match="sede"):
        finished.snakemake("all", "--cores", "1", "--dry-run", "--config", "sede=1")


def test_several_campaigns_of_one_finger_are_joined_first(finished):
    for name, protocol, trials in (("monday", "single_step", 2), ("tuesday", "levels", 3)):
        write_recordings(
            CaseSpec(3, (), (), (), protocol, trials, "white"), finished.root / name
        )  # a seed's finger is drawn before its loads
    (finished.root / "several.yaml").write_text("campaign: [monday, tuesday]\nout: both\n")
    finished.snakemake("--cores", "1", "--until", "angles", settings=("several.yaml",))
    angles = open_artifact(finished.root / "both/angles.nc", angles_spec.SPEC)
    first, second = (f"s{k}_trial_00" for k in (1, 2))
    expected = [f"{first}1", f"{first}2", f"{second}1", f"{second}2", f"{second}3"]
    assert angles["trial"].values.tolist() == expected
    said = finished.snakemake(
        "--cores", "1", "--until", "angles", "--dry-run", settings=("several.yaml",)
    )
    assert planned_rules(said) == set()
