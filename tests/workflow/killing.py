"""What tests that kill commands share: start, kill, and look at what is left."""

import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

from softfinger.artifacts import open_artifact, open_tree
from softfinger.artifacts.specs import list_specs

PROJECT = Path(__file__).parents[2]
SIGNALS = (signal.SIGKILL, signal.SIGTERM, signal.SIGHUP, signal.SIGINT)
SPECS = {spec.name: spec for spec in list_specs()}
CODE = "from softfinger.cli import main; main()"
SMALL = """\
trials_per_job: 1
virtual_rig: {n_trials: 3, duration_s: 3.0, fps: 30.0, load_time_s: [0.0, 3.0]}
estimation: {chains: 2, tune: 50, draws: 50}
propagation: {draws: 50, band_samples: 256}
mismatch: {bootstrap_replicates: 99, sample_repaired: false}
"""


def start(folder: Path, *arguments: object) -> subprocess.Popen:
    """A command in its own session, as a terminal's would be; `said.txt` has what it said."""
    said = (folder / "said.txt").open("ab")
    running = subprocess.Popen(
        [sys.executable, "-c", CODE, *map(str, arguments)],
        cwd=folder,
        env=os.environ | {"PYTHONPATH": str(PROJECT / "src")},
        stdin=subprocess.DEVNULL,
        stdout=subprocess.DEVNULL,
        stderr=said,
        start_new_session=True,
        preexec_fn=hear_ctrl_c,
    )
    said.close()
    return running


def hear_ctrl_c() -> None:
    """Where tests run in the background of a shell, Ctrl-C has been switched off."""
    signal.signal(signal.SIGINT, signal.SIG_DFL)


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


def kill(running: subprocess.Popen, number: int, folder: Path) -> None:
    """Send a signal to a command alone; nothing that it started goes on."""
    os.kill(running.pid, number)
    running.wait()
    for _ in range(600):
        if not list_running(folder):
            return
        time.sleep(0.1)
    assert list_running(folder) == []


def check_whole(out: Path) -> None:
    """Whatever has its final name is whole."""
    for path in [*out.glob("*.nc"), *(out / "markers").glob("*.nc")]:
        spec = SPECS["markers" if path.parent.name == "markers" else path.stem]
        (open_tree if spec.groups else open_artifact)(path, spec)
    for path in out.glob("*.json"):
        json.loads(path.read_text())
    for path in out.glob("*.html"):
        assert path.read_text().rstrip().endswith("</html>")


def read_results(out: Path) -> dict[str, bytes]:
    """Every file of results: name → bytes, without logs and what Snakemake notes."""
    return {
        str(path.relative_to(out)): path.read_bytes()
        for path in out.rglob("*")
        if path.is_file() and not {"logs", ".snakemake"} & set(path.relative_to(out).parts)
    }
