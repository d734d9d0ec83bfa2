"""A round: what is settled, what a rig must do, and whether it followed the plan."""

import sys

import pytest

from softfinger.artifacts.verdict import Verdict, write_verdict
from softfinger.faults import Fault
from softfinger.stages.loop import is_settled, list_deviations, record, tell_loop

LOADS = [{"time_s": [0.0, 4.0, 4.0, 8.0], "load": [5.0, 5.0, 1.0, 1.0]}]
WRITER = """
import sys
from pathlib import Path
out = Path(sys.argv[2])
out.mkdir()
for name in ("angles", "load"):
    (out / name).mkdir()
(out / "campaign.yaml").write_text(
    "{version: 1, name: a, source: synthetic, finger: {joints: 1, wire_offset_m: 0.005}}")
(out / "trials.csv").write_text("trial,angles,load\\nt1,angles/t1.csv,load/t1.csv\\n")
(out / "angles/t1.csv").write_text("time_s,q1_rad\\n0,0\\n1,0.1\\n")
(out / "load/t1.csv").write_text("time_s,tension_n\\n" + sys.argv[3].replace(";", "\\n"))
"""
FOLLOWED, HALVED = "0,5;4,5;4.00001,1;8,1", "0,2.5;8,2.5"


def build_verdict(decision, hidden=()):
    nothing = {
        "location": None, "elpd": None, "free_form": None, "next_experiment": None,
        "explained_spread": {}, "set_aside": [], "n_trials": 4, "effects": [],
        "residual_rms_rad": {"baseline": 0.003, "final": 0.003, "noise": 0.003},
    }  # fmt: skip
    left = [["actuator_lag"], ["camera_delay"]] if decision == "ambiguous" else []
    return Verdict(
        campaign="a", decision=decision, equivalent=left, not_testable=list(hidden), **nothing
    )


def test_a_loop_ends_where_nothing_is_open():
    assert is_settled(build_verdict("adequate"))
    assert is_settled(build_verdict("unlisted"))
    assert not is_settled(build_verdict("adequate", ["gravity"]))
    assert not is_settled(build_verdict("ambiguous"))


@pytest.mark.parametrize(("rows", "kept"), [(FOLLOWED, True), (HALVED, False)])
def test_a_rig_records_in_its_own_process_and_is_compared_with_its_plan(tmp_path, rows, kept):
    script = tmp_path / "rig.py"
    script.write_text(WRITER)
    folder = tmp_path / "recordings"
    record(f"{sys.executable} {script} {{plan}} {{out}} '{rows}'", tmp_path / "plan", folder, 1)
    said = list_deviations(folder, LOADS)
    assert (said == []) == kept
    assert kept or "the log counts" in said[0]


@pytest.mark.parametrize(
    ("command", "words"),
    [
        ("rig {plan}", "lacks {out}"),
        ("/nowhere/rig {plan} {out}", "cannot be run"),
        (f"{sys.executable} -c 'raise SystemExit(3)' {{plan}} {{out}}", "status 3"),
        (f"{sys.executable} -c pass {{plan}} {{out}}", "left no campaign"),
    ],
)
def test_a_rig_that_fails_is_told_in_a_sentence(tmp_path, command, words):
    with pytest.raises(Fault, match=words):
        record(command, tmp_path / "plan.yaml", tmp_path / "out", 1)


def test_the_page_has_every_round(tmp_path):
    folders = [tmp_path / "round_0", tmp_path / "round_1"]
    for folder, decision in zip(folders, ("ambiguous", "adequate"), strict=True):
        (folder / "results").mkdir(parents=True)
        write_verdict(build_verdict(decision), folder / "results/verdict.json")
    (folders[1] / "plan.json").write_text('{"statement": "10 trials of <steps>."}')
    (folders[1] / "plan.png").write_bytes(b"png")
    (folders[1] / "deviations.json").write_text('["t1: it differs"]')
    tell_loop(folders, tmp_path / "loop.html")
    page = (tmp_path / "loop.html").read_text()
    assert page.index("Round 0") < page.index("ambiguous") < page.index("Round 1")
    for said in ("10 trials of &lt;steps&gt;.", "t1: it differs", "adequate", "data:image/png"):
        assert said in page
