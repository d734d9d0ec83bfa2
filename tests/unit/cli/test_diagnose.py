"""`softfinger diagnose` on a small campaign: its report of its own."""

import json
import re
from pathlib import Path

import pytest
from typer.testing import CliRunner

from softfinger.artifacts.verdict import read_verdict
from softfinger.cli import app
from softfinger.cli.diagnose import describe_verdict

EXAMPLE = Path(__file__).parents[3] / "data/example"


@pytest.fixture(scope="module")
def diagnosed(tmp_path_factory):
    out = tmp_path_factory.mktemp("diagnosis") / "out"
    arguments = ["diagnose", str(EXAMPLE), "--out", str(out), "--no-mcmc", "--json"]
    done = CliRunner().invoke(app, arguments)
    assert done.exit_code == 0, done.stderr
    return out, done.stdout


def test_the_verdict_goes_to_programs(diagnosed):
    out, said = diagnosed
    assert json.loads(said) == json.loads((out / "verdict.json").read_text(encoding="utf-8"))


def test_a_diagnosis_writes_a_report_of_its_own(diagnosed):
    out, _ = diagnosed
    page = (out / "report.html").read_text(encoding="utf-8")
    assert re.findall(r'<section id="(\w+)"', page) == [
        "verdict", "motion", "remains", "measurement", "explained", "next",
    ]  # fmt: skip
    assert not re.search(r"(?:src|href|url)\s*[=(]\s*[\"']?https?:", page)
    for name in ("evidence", "repair", "location"):
        assert f'id="figure-{name}"' in page
    verdict = read_verdict(out / "verdict.json")
    for finding in verdict.measurement[:3]:
        assert finding.statement[:30] in page
    size = f"{verdict.remaining.rms_over_noise:.2f} times what the measurement allows"
    assert f"Under the final model what remains within trials is {size}" in page


def test_the_terminal_states_what_is_left_of_unlisted_physics(diagnosed, tmp_path):
    known = json.loads((diagnosed[0] / "verdict.json").read_text(encoding="utf-8"))
    rest = {"rms_over_noise": 1.4, "p_value": 0.0, "where": "joint 2, creep, from 3 s after"}
    best = {"effects": ["gravity", "inertia"], "gain_nats": 90.0, "share": 0.6}
    best["amplitudes_cover_zero"] = False
    known |= {"decision": "unlisted", "effects": [], "remaining": rest, "next_experiment": None}
    file = tmp_path / "verdict.json"
    for explained, stated in (([], "No listed"), ([best], "The best listed set, gravity and")):
        file.write_text(json.dumps(known | {"explained": explained}), encoding="utf-8")
        heading, what, left = describe_verdict(file)
        assert heading.endswith(": unlisted")
        assert what.startswith(stated)
        assert left.endswith(
            "1.40 times what the measurement allows: joint 2, creep, from 3 s after."
        )
