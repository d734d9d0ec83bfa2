"""`softfinger run` is killed forty times at random moments; the next one goes on as if nothing."""

import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest

from softfinger.artifacts import open_artifact, open_tree
from softfinger.artifacts.specs import list_specs

PROJECT = Path(__file__).parents[2]
KILLS = 40
LONGEST_S = 40.0
SIGNALS = (signal.SIGKILL, signal.SIGTERM, signal.SIGHUP, signal.SIGINT)
SPECS = {spec.name: spec for spec in list_specs()}
SMALL = """\
estimation: {chains: 2, tune: 50, draws: 50}
propagation: {draws: 50, band_samples: 256}
mismatch: {bootstrap_replicates: 99, sample_repaired: false}
"""


def start(folder: Path, out: str) -> subprocess.Popen:
    code = "from softfinger.cli import main; main()"
    example = str(PROJECT / "data/example")
    return subprocess.Popen(
        [sys.executable, "-c", code, "run", example, "--out", out, "--config", "small.yaml"],
        cwd=folder,
        env=os.environ | {"PYTHONPATH": str(PROJECT / "src")},
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
        start_new_session=True,
    )


def list_running(folder: Path) -> list[str]:
    """Commands of processes that work in a folder."""
    found = []
    for entry in Path("/proc").iterdir():
        if entry.name.isdigit():
            try:
                if (entry / "cwd").resolve().is_relative_to(folder.resolve()):
                    found.append((entry / "cmdline").read_text().replace("\0", " "))
            except OSError:
                continue  # it has just ended
    return found


def check_whole(out: Path) -> None:
    for path in out.glob("*.nc"):
        spec = SPECS[path.stem]
        (open_tree if spec.groups else open_artifact)(path, spec)
    for path in out.glob("*.json"):
        json.loads(path.read_text())


@pytest.mark.slow
def test_killed_forty_times_it_ends_as_if_nothing_had_been(tmp_path):
    (tmp_path / "small.yaml").write_text(SMALL)
    assert start(tmp_path, "whole").wait() == 0
    rng = np.random.default_rng(7)
    for kill in range(KILLS):
        running = start(tmp_path, "killed")
        time.sleep(rng.uniform(0.5, LONGEST_S))
        os.kill(running.pid, SIGNALS[kill % len(SIGNALS)])
        running.wait()
        for _ in range(600):
            if not list_running(tmp_path):
                break
            time.sleep(0.1)
        assert list_running(tmp_path) == []
        check_whole(tmp_path / "killed")
    assert start(tmp_path, "killed").wait() == 0
    names = sorted(path.name for path in (tmp_path / "whole").glob("*.nc"))
    assert len(names) >= 8
    for name in names:
        whole, killed = (tmp_path / out / name for out in ("whole", "killed"))
        assert killed.read_bytes() == whole.read_bytes(), name
    assert not list((tmp_path / "killed").rglob("*.partial*"))
