"""The proof's workflow: what it plans, and that its campaigns' names tell nothing."""

import re
import subprocess
import sys
from pathlib import Path

PROJECT = Path(__file__).parents[2]


def _plan(folder, **settings):
    command = [sys.executable, "-m", "snakemake", "--snakefile", "workflow/concealed.smk"]
    command += ["--workflow-profile", "profiles/default", "--dry-run", "--config"]
    command += [f"{k}={v}" for k, v in ({"out": folder} | settings).items()]
    done = subprocess.run(command, cwd=PROJECT, capture_output=True, text=True, check=False)
    return done.returncode, done.stdout + done.stderr


def test_every_campaign_is_sealed_diagnosed_and_scored(tmp_path):
    status, said = _plan(tmp_path, campaigns=3, clean=2, twins=1, foreign=1, seed=7, limits=4)
    assert status == 0, said
    table = dict(re.findall(r"^(\w+) +(\d+)$", said.split("Job stats:")[1], re.MULTILINE))
    assert {table[rule] for rule in ("conceal", "diagnose_blind", "rivals")} == {
        "10"
    }  # three, two clean ones, a pair, a foreign law, and the paper's own case, twice
    assert table["limit"] == "4"
    assert table["score"] == "1"
    names = set(re.findall(r"seal/(\w+)\.txt", said))
    assert len(names) == 10
    assert all(re.fullmatch("[0-9a-f]{10}", name) for name in names)


def test_an_unknown_knob_stops_before_any_work(tmp_path):
    status, said = _plan(tmp_path, campaign=3)
    assert status != 0
    assert "campaign" in said
