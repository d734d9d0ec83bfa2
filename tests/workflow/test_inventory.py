"""The report of any model has the same sections, checks and figures."""

import re
from pathlib import Path

import pytest
from typer.testing import CliRunner

from softfinger.artifacts import open_tree
from softfinger.artifacts.specs.checks import SPEC as CHECKS
from softfinger.artifacts.specs.summary import SPEC as SUMMARY
from softfinger.cli import app
from softfinger.provenance import PROJECT

FEW = "estimation: {chains: 2, tune: 60, draws: 60, cores: 1}\n"
MODEL = """\
version: 1
joint: three_element
torque: constant_arm
effects:
  - {id: moment_arm, form: paper_geometry}
"""


def softfinger(verb: str, out: Path, *more: str) -> None:
    arguments = [verb, str(PROJECT / "data/example"), "--out", str(out), *more]
    CliRunner().invoke(app, arguments, catch_exceptions=False)


def run_to_report(folder: Path, model: str | None) -> dict[str, set[str]]:
    """Fit and report the example with few draws: sections, checks, figures and groups."""
    config = folder / "few.yaml"
    config.write_text(FEW + ("" if model is None else f"model: {folder / 'model.yaml'}\n"))
    (folder / "model.yaml").write_text(model or "")
    for verb in ("angles", "fit", "summarise", "report"):
        softfinger(verb, folder / "out", "--config", str(config))
    page = (folder / "out/report.html").read_text(encoding="utf-8")
    page = re.sub('"data:[^"]*"', '""', page)  # pictures
    trees = [open_tree(folder / f"out/{spec.name}.nc", spec) for spec in (CHECKS, SUMMARY)]
    return {
        "sections": set(re.findall(r'<(?:section|details class="part") id="(\w+)"', page)),
        "checks": set(re.findall(r'<td role="cell">([^<]+)</td><td role="cell" data', page)),
        "not run": set(re.findall("[^.>]*was not run", page)),
        "figures": set(re.findall(r'<figure id="figure-(\w+)"', page)),
        "groups": {str(name) for tree in trees for name in tree.children},
    }


@pytest.fixture(scope="module")
def inventories(tmp_path_factory):
    return [run_to_report(tmp_path_factory.mktemp("run"), model) for model in (None, MODEL)]


def test_a_model_with_effects_has_the_report_of_the_base(inventories):
    base, effects = inventories
    for part in ("sections", "checks", "not run", "figures"):
        assert effects[part] == base[part] != set()
    assert effects["groups"] - base["groups"] == {"effects"}
    assert base["groups"] <= effects["groups"]
