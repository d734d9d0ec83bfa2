"""Wall time of the whole line, from the virtual rig to the report; set-up is not counted."""

from __future__ import annotations

import subprocess
import sys
import tempfile
import time

from softfinger.provenance import PROJECT

CORES = 2
JOBS = {"main": ("default",), "quick": ("default", "quick")}


def measure_long() -> dict[str, float]:
    """Seconds of `make run` and `make quick`, each in an empty folder."""
    return {f"{name}_job_seconds": run_job(config) for name, config in JOBS.items()}


def run_job(config: tuple[str, ...]) -> float:
    """Run the workflow with these configuration files; seconds."""
    files = [str(PROJECT / f"config/{name}.yaml") for name in config]
    with tempfile.TemporaryDirectory() as folder:
        command = [
            sys.executable, "-m", "snakemake", "--cores", str(CORES), "--quiet", "all",
            "--snakefile", str(PROJECT / "workflow/Snakefile"),
            "--workflow-profile", str(PROJECT / "profiles/default"), "--directory", folder,
            "--configfile", *files, "--config", "out=.",
        ]  # fmt: skip
        start = time.perf_counter()
        subprocess.run(command, check=True)
        return time.perf_counter() - start
