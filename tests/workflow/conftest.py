"""One small run of the whole workflow from raw video, shared by the tests of this folder."""

import os
import shutil
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

import pytest

PROJECT = Path(__file__).parents[2]
SMALL = """\
out: results
trials_per_job: 2
virtual_rig: {n_trials: 3, duration_s: 3.0, fps: 30.0, load_time_s: [0.0, 3.0]}
estimation: {chains: 2, tune: 100, draws: 200, predictive_draws: 40}
mismatch: {bootstrap_replicates: 99, false_alarm_probability: 0.01}
propagation:
  {draws: 50, sampled_draws: 8, draw_samples: 64, band_samples: 512, band_times: 61,
   density_times_s: [0.0, 0.3, 1.0, 3.0], density_angles: 64}
"""


@dataclass(frozen=True)
class Project:
    """A folder in which the workflow was run."""

    root: Path

    def snakemake(self, *arguments: str, settings: tuple[str, ...] = ()) -> str:
        """Run Snakemake on the code in this folder; return what it prints."""
        files = ["--configfile", "small.yaml", *settings]
        command = [sys.executable, "-m", "snakemake", *arguments, *files]
        environment = os.environ | {"PYTHONPATH": str(self.root / "src")}
        done = subprocess.run(
            command, cwd=self.root, env=environment, capture_output=True, text=True, check=False
        )
        assert done.returncode == 0, done.stdout + done.stderr
        return done.stdout + done.stderr


@pytest.fixture(scope="session")
def finished(tmp_path_factory) -> Project:
    root = tmp_path_factory.mktemp("project")
    for name in ("src", "workflow", "config", "profiles", "environment.lock"):
        (root / name).symlink_to(PROJECT / name)  # what is compiled is compiled once
    (root / "small.yaml").write_text(SMALL)
    project = Project(root)
    project.snakemake("all", "--cores", "1")  # two jobs would compile the same at the same time
    return project


@pytest.fixture
def editable(finished):
    """The finished project, with a copy of the code that a test may edit."""
    source = finished.root / "src"
    source.unlink()
    shutil.copytree(PROJECT / "src", source, ignore=shutil.ignore_patterns("__pycache__"))
    yield finished
    shutil.rmtree(source)
    source.symlink_to(PROJECT / "src")
