"""Wall time of the whole line, from the virtual rig to the report; set-up is not counted.

Warm, the code runs where it is and everything is compiled. Cold, it runs from a copy of what Git
knows, in which nothing is compiled, with an empty folder for what PyMC compiles.
"""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from softfinger.provenance import PROJECT

CORES = 2
JOBS = {"main": ("default",), "quick": ("default", "quick")}


def measure_long() -> dict[str, float]:
    """Seconds of `make quick` in a fresh clone, then of both jobs, each in an empty folder."""
    figures = {"quick_job_cold_seconds": run_cold(JOBS["quick"])}
    run_job(JOBS["quick"])  # compiles
    return figures | {f"{name}_job_seconds": run_job(config) for name, config in JOBS.items()}


def run_cold(config: tuple[str, ...]) -> float:
    """Run the workflow from a copy of the files that Git knows; seconds."""
    listed = subprocess.run(
        ["git", "ls-files", "-z"], cwd=PROJECT, capture_output=True, text=True, check=True
    )
    with tempfile.TemporaryDirectory() as folder:
        clone = Path(folder) / "clone"
        for name in filter(None, listed.stdout.split("\0")):
            (clone / name).parent.mkdir(parents=True, exist_ok=True)
            shutil.copy2(PROJECT / name, clone / name)
        flags = f"base_compiledir={folder}/compiled"
        return run_job(config, clone, {"PYTENSOR_FLAGS": flags})


def run_job(
    config: tuple[str, ...], project: Path = PROJECT, environment: dict[str, str] | None = None
) -> float:
    """Run the workflow of a project with these configuration files; seconds."""
    files = [str(project / f"config/{name}.yaml") for name in config]
    around = os.environ | {"PYTHONPATH": str(project / "src")} | (environment or {})
    with tempfile.TemporaryDirectory() as folder:
        command = [
            sys.executable, "-m", "snakemake", "--cores", str(CORES), "--quiet", "all",
            "--snakefile", str(project / "workflow/Snakefile"),
            "--workflow-profile", str(project / "profiles/default"), "--directory", folder,
            "--configfile", *files, "--config", "out=.",
        ]  # fmt: skip
        start = time.perf_counter()
        subprocess.run(command, check=True, env=around)
        return time.perf_counter() - start
