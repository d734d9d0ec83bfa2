"""The workflow and its jobs are killed at random moments; the next run mends everything."""

import os
import shutil
import signal
import subprocess
import sys
import time

import numpy as np
import pytest

from softfinger.artifacts import open_artifact, open_tree
from softfinger.artifacts.specs import list_specs

KILLS = 20
LONGEST = 12.0  # seconds until a kill
SPECS = {spec.name: spec for spec in list_specs()}


def start(project, *arguments: str) -> subprocess.Popen:
    command = [sys.executable, "-m", "snakemake", *arguments, "--cores", "2"]
    command += ["--configfile", "small.yaml", "--config", "out=killed"]
    environment = os.environ | {"PYTHONPATH": str(project.root / "src")}
    return subprocess.Popen(
        command,
        cwd=project.root,
        env=environment,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
        start_new_session=True,
    )


def list_jobs(session: int) -> list[int]:
    """Processes of a session but its leader: the jobs and what they started."""
    said = subprocess.run(
        ["ps", "-o", "pid=", "--sid", str(session)], capture_output=True, text=True, check=False
    ).stdout
    return [int(pid) for pid in said.split() if int(pid) != session]


def check_whole(folder) -> None:
    """Every artifact that is there is whole."""
    for path in [*folder.glob("*.nc"), *(folder / "markers").glob("*.nc")]:
        spec = SPECS["markers" if path.parent.name == "markers" else path.stem]
        (open_tree if spec.groups else open_artifact)(path, spec)


@pytest.mark.slow
def test_killed_twenty_times_it_ends_as_if_nothing_had_been(finished):
    rng = np.random.default_rng(11)
    folder = finished.root / "killed"
    shutil.rmtree(folder, ignore_errors=True)
    killed = {"workflow": 0, "job": 0}
    while sum(killed.values()) < KILLS:
        running = start(finished, "all")
        time.sleep(rng.uniform(1.0, LONGEST))
        jobs = list_jobs(running.pid)
        if running.poll() is not None:  # it was done before: begin again
            shutil.rmtree(folder, ignore_errors=True)
            continue
        if jobs and rng.random() < 0.5:
            os.kill(int(rng.choice(jobs)), signal.SIGKILL)
            killed["job"] += 1
            time.sleep(1.0)
        else:
            killed["workflow"] += 1
        os.killpg(running.pid, signal.SIGKILL)
        running.wait()
        check_whole(folder)
        assert start(finished, "all", "--unlock").wait() == 0
    assert min(killed.values()) > 0
    assert start(finished, "all").wait() == 0
    names = [path.name for path in (finished.root / "results").glob("*.nc")]
    assert len(names) >= 8
    for name in names:
        assert (folder / name).read_bytes() == (finished.root / "results" / name).read_bytes(), name
    assert not list(folder.rglob("*.partial*"))
