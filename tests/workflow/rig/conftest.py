import shutil
import subprocess
import sys
import time
from dataclasses import dataclass
from pathlib import Path

import pytest
from ruamel.yaml import YAML

from softfinger.rig.link import SerialLink
from softfinger.rig.recorder import record_campaign

EXAMPLE = Path(__file__).parents[3] / "docs/rig/plan.yaml"
COMMAND = (sys.executable, "-c", "from softfinger.rig.cli import app; app()")
TIME_SCALE, FPS, WATCHDOG_S, SEED = 10.0, 10.0, 2.5, 11
PATIENCE_S = 60.0  # only a hanging test waits so long


@dataclass
class SimulatedRig:
    """A simulator in its own process."""

    process: subprocess.Popen
    port: str
    camera: str
    transcript: Path

    def read_transcript(self) -> list[str]:
        return self.transcript.read_text().splitlines()

    def wait_for(self, words: str, since: int) -> str:
        """Wait until a line of the transcript, from line `since` on, holds these words."""
        deadline = time.monotonic() + PATIENCE_S
        while time.monotonic() < deadline:
            for line in self.read_transcript()[since:]:
                if words in line:
                    return line
            time.sleep(0.02)
        raise AssertionError(f"'{words}' is not in {self.read_transcript()[since:]}")

    def rehearse(self, fault: str, after_ms: int = 200) -> None:
        with SerialLink(self.port) as link:
            link.discard()
            link.request("rehearse", PATIENCE_S, fault=fault, after_ms=after_ms)

    def record(self, plan: Path, folder: Path) -> None:
        record_campaign(plan, folder, self.port, self.camera, {"humidity_pct": 41.5})

    def end(self) -> None:
        self.process.terminate()
        self.process.wait(PATIENCE_S)
        self.process.stdout.close()


def start_simulator(folder: Path, time_scale: float = TIME_SCALE) -> SimulatedRig:
    transcript = folder / "transcript.txt"
    options = {"time-scale": time_scale, "fps": FPS, "watchdog-s": WATCHDOG_S, "seed": SEED}
    arguments = [f"--{key}={value}" for key, value in options.items()]
    process = subprocess.Popen(
        [*COMMAND, "simulate", *arguments, f"--transcript={transcript}"],
        stdout=subprocess.PIPE,
        text=True,
    )
    said = dict(process.stdout.readline().split() for _ in range(2))
    return SimulatedRig(process, said["port"], said["camera"], transcript)


@pytest.fixture(scope="session")
def rig(tmp_path_factory):
    simulated = start_simulator(tmp_path_factory.mktemp("simulator"))
    yield simulated
    simulated.end()


@pytest.fixture
def rig_of_its_own(tmp_path):
    """For tests after which nothing can be done with it any more."""
    simulated = start_simulator(tmp_path)
    yield simulated
    simulated.end()


@pytest.fixture
def calm_rig(tmp_path):
    """Slow enough for a busy computer."""
    simulated = start_simulator(tmp_path, time_scale=2.0)
    yield simulated
    simulated.end()


@pytest.fixture(scope="session")
def plan_file(tmp_path_factory) -> Path:
    """Two short trials, the second longer than the first."""
    plan = YAML(typ="safe").load(EXAMPLE)
    plan["campaign"]["camera"]["fps"] = FPS
    plan["safety"] |= {"answer_timeout_s": 10.0, "stream_timeout_s": 2.0, "camera_timeout_s": 10.0}
    plan["safety"]["heartbeat_s"] = 0.1
    plan["recording"] |= {"lead_in_s": 0.3, "rest_s": 0.3, "repeats": 1, "order": "as_listed"}
    plan["profiles"] = [
        {"name": "unload", "shape": "steps", "levels_n": [8.0, 3.0], "hold_s": 0.4},
        {"name": "climb", "shape": "ramps", "levels_n": [6.0], "ramp_s": 1.0, "hold_s": 1.0},
    ]
    path = tmp_path_factory.mktemp("plan") / "plan.yaml"
    YAML().dump(plan, path)
    return path


@pytest.fixture(scope="session")
def complete(rig, plan_file, tmp_path_factory) -> Path:
    """The campaign folder of an undisturbed session."""
    folder = tmp_path_factory.mktemp("complete") / "campaign"
    rig.record(plan_file, folder)
    return folder


@pytest.fixture
def half_done(complete, tmp_path) -> Path:
    """A folder that was interrupted after its first trial."""
    folder = tmp_path / "campaign"
    shutil.copytree(complete, folder)
    table = (folder / "trials.csv").read_text().splitlines()
    (folder / "trials.csv").write_text("\n".join(table[:2]) + "\n")
    for path in folder.rglob("trial_002*"):
        path.unlink()
    return folder


@pytest.fixture(scope="session")
def read_files():
    """Read every file of a folder but the preview: name → bytes."""

    def read(folder: Path) -> dict[str, bytes]:
        return {
            str(path.relative_to(folder)): path.read_bytes()
            for path in folder.rglob("*")
            if path.is_file() and path.name != "preview.jpg"
        }

    return read


@pytest.fixture
def long_plan(plan_file, half_done, tmp_path) -> Path:
    """The plan of a folder whose second trial lasts until something happens."""
    plan = YAML(typ="safe").load(plan_file)
    plan["profiles"][1]["hold_s"] = 60.0
    path = half_done / "recording/plan.yaml"
    YAML().dump(plan, path)
    return path
