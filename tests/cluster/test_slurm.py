"""The quick workflow through Slurm on this machine: a job is killed, the results are the same."""

import os
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

PROJECT = Path(__file__).parents[2]
SCRIPT = Path(__file__).with_name("local_slurm.sh")
QUICK = ["--configfile", "config/default.yaml", "config/quick.yaml"]


@pytest.fixture(scope="module")
def environment(tmp_path_factory):
    if not (shutil.which("slurmctld") and shutil.which("munged")):
        pytest.skip(
            "Slurm is not installed: apt-get install --no-install-recommends slurm-wlm munge"
        )
    folder = tmp_path_factory.mktemp("slurm")
    subprocess.run(["bash", str(SCRIPT), "up", str(folder)], check=True)
    path = f"{folder / 'bin'}:{os.environ['PATH']}"
    yield os.environ | {"SLURM_CONF": str(folder / "slurm.conf"), "PATH": path}
    subprocess.run(["bash", str(SCRIPT), "down", str(folder)], check=True)


@pytest.fixture(scope="module")
def project(tmp_path_factory):
    root = tmp_path_factory.mktemp("cluster")
    for name in ("src", "workflow", "config", "profiles"):
        shutil.copytree(PROJECT / name, root / name, ignore=shutil.ignore_patterns("*.nb?"))
    shutil.copy(PROJECT / "environment.lock", root)
    return root


def build_command(out: str, *arguments: str) -> list[str]:
    snakemake = [sys.executable, "-m", "snakemake", "all", *QUICK, "--config", f"out={out}"]
    return [*snakemake, *arguments]


def kill_a_job(environment, log: Path) -> str:
    """Kill -9 the first running job's own process; its name."""
    for _ in range(600):
        time.sleep(0.5)
        said = subprocess.run(
            ["pgrep", "-f", "mode subprocess|executor slurm-jobstep"],
            capture_output=True, text=True, check=False,
        ).stdout.split()  # fmt: skip
        if said:
            time.sleep(3.0)
            for pid in said:
                try:
                    os.kill(int(pid), signal.SIGKILL)
                except ProcessLookupError:
                    continue
                return pid
    raise AssertionError(f"no job ever ran: {log.read_text()[-3000:]}")


@pytest.mark.slow
def test_the_quick_workflow_survives_a_killed_job_and_gives_the_same_results(project, environment):
    environment = environment | {"PYTHONPATH": str(project / "src")}
    local = subprocess.run(
        build_command("results/local", "--cores", "2"),
        cwd=project, env=environment, capture_output=True, text=True, check=False,
    )  # fmt: skip
    assert local.returncode == 0, local.stderr[-3000:]
    log = project / "cluster.log"
    with log.open("w") as stream:
        running = subprocess.Popen(
            build_command("results/cluster", "--workflow-profile", "profiles/slurm"),
            cwd=project, env=environment, stdout=stream, stderr=stream,
        )  # fmt: skip
        kill_a_job(environment, log)
        status = running.wait()
    said = log.read_text()
    assert status == 0, said[-5000:]
    assert "Trying to restart job" in said or "restart" in said.lower(), said[-5000:]
    names = sorted(path.name for path in (project / "results/local").glob("*.nc"))
    assert len(names) >= 8
    for name in names:
        one, two = (project / "results" / out / name for out in ("local", "cluster"))
        assert one.read_bytes() == two.read_bytes(), name
