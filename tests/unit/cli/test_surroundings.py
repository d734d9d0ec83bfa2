"""Where a verb runs may be odd: no home, a clock that jumps, a folder that vanishes, no room."""

import os
import resource
import shutil
import subprocess
import sys
import time
from pathlib import Path

import pytest
from typer.testing import CliRunner

from softfinger.cli import app

PROJECT = Path(__file__).parents[3]
EXAMPLE = str(PROJECT / "data/example")
CODE = "from softfinger.cli import main; main()"
# The folder of results goes, the moment before a file is put into its place there.
VANISHING = """\
import shutil, sys
from softfinger.cli import main
def vanish(event, what):
    if event == "os.rename" and str(what[1]).endswith("angles.nc"):
        shutil.rmtree("out")
sys.addaudithook(vanish)
main()
"""
# Every look at the time of day finds another day.
JUMPING = """\
import itertools, time
jumps = itertools.cycle([0.0, -86400.0, 86400.0, -7 * 86400.0])
real = time.time
time.time = lambda: real() + next(jumps)
from softfinger.cli import main
main()
"""


def start(folder, *arguments, code=CODE, **options):
    """Run the command line in a process of its own."""
    return subprocess.run(
        [sys.executable, "-c", code, *arguments],
        cwd=folder, capture_output=True, text=True, check=False, **options,
    )  # fmt: skip


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    """Results of `angles` where nothing is odd: name → bytes."""
    out = tmp_path_factory.mktemp("whole") / "out"
    assert CliRunner().invoke(app, ["angles", EXAMPLE, "--out", str(out)]).exit_code == 0
    return read(out)


def read(folder):
    return {path.name: path.read_bytes() for path in folder.iterdir()}


def assert_one_sentence(status, _, error):
    assert status == 1
    assert error.count("\n") == 1
    assert "unexpected" not in error
    assert "Traceback" not in error


@pytest.mark.parametrize("home", [None, "/nonexistent", "/dev/null"])
def test_without_a_home_or_a_cache_the_results_are_the_same(tmp_path, made, home):
    kept = {"PATH", "PYTHONPATH", "LANG", "VIRTUAL_ENV"}
    environment = {key: value for key, value in os.environ.items() if key in kept}
    if home:
        environment |= {"HOME": home, "XDG_CACHE_HOME": f"{home}/cache"}
    done = start(tmp_path, "angles", EXAMPLE, "--out", "out", env=environment)
    assert (done.returncode, done.stderr) == (0, "")
    assert read(tmp_path / "out") == made


def test_a_clock_that_jumps_changes_nothing(tmp_path, made):
    done = start(tmp_path, "angles", EXAMPLE, "--out", "out", code=JUMPING)
    assert (done.returncode, done.stderr) == (0, "")
    assert read(tmp_path / "out") == made


def test_a_folder_of_results_that_vanishes_is_one_sentence(call_here, tmp_path, made):
    done = start(tmp_path, "angles", EXAMPLE, "--out", "out", code=VANISHING)
    assert_one_sentence(done.returncode, done.stdout, done.stderr)
    assert "out" in done.stderr
    assert call_here("angles", EXAMPLE, "--out", "out").status == 0
    assert read(tmp_path / "out") == made


@pytest.mark.skipif(not Path("/sys/kernel").is_dir(), reason="nowhere that cannot be written")
@pytest.mark.parametrize("verb", [["angles", EXAMPLE], ["run", EXAMPLE]])
def test_a_folder_that_cannot_be_written_is_one_sentence(call_here, verb):
    done = call_here(*verb, "--out", "/sys/kernel/results")
    assert_one_sentence(*done)
    assert "/sys/kernel/results" in done.stderr


@pytest.mark.parametrize("verb", [["angles", EXAMPLE], ["virtual-rig"]])
@pytest.mark.parametrize("room", [0, 16_000])
def test_a_file_for_which_there_is_no_room_is_one_sentence(call_here, tmp_path, verb, room):
    (tmp_path / "small.yaml").write_text("virtual_rig: {n_trials: 3, level: angles}\n")
    arguments = [*verb, "--config", "small.yaml", "--out"]
    largest = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (room, largest[1]))
    try:
        done = call_here(*arguments, "out")
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, largest)
    assert_one_sentence(*done)
    assert [path for path in (tmp_path / "out").rglob("*") if "partial" in path.name] == []
    assert list((tmp_path / "out").glob("*.nc")) == []
    shutil.rmtree(tmp_path / "out", ignore_errors=True)  # without room there is none
    assert call_here(*arguments, "out").status == 0


STARTING = """\
import sys
from softfinger.cli.supervision import run_to_end
from softfinger.faults import Fault
from softfinger.gate.cells import read_book
from softfinger.gate.child import read_in_child
try:
    list(read_in_child(read_book, "none.xlsx", False))
except Fault as fault:
    print(fault)
print(run_to_end([sys.executable, "-c", "import json, numpy, snakemake"]))
"""


def test_no_module_comes_from_the_folder_in_which_somebody_works(tmp_path):
    for name in ("json", "numpy", "ctypes", "softfinger", "snakemake", "common", "python_calamine"):
        (tmp_path / f"{name}.py").write_text("open('owned', 'w')\nraise SystemExit(9)\n")
    done = subprocess.run(
        [sys.executable, "-P", "-c", STARTING],
        cwd=tmp_path, capture_output=True, text=True, check=False,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    assert "cannot be read as a workbook" in done.stdout
    assert done.stdout.endswith("\n0\n")
    assert not (tmp_path / "owned").exists()


HOLD = """\
import sys, time
from pathlib import Path
from softfinger.cli.supervision import hold_folder
hold_folder(Path(sys.argv[1]))
print("held", flush=True)
time.sleep(300)
"""


@pytest.fixture
def holder(tmp_path):
    """A process that works on a folder."""
    (tmp_path / "out").mkdir()
    command = [sys.executable, "-c", HOLD, str(tmp_path / "out")]
    running = subprocess.Popen(command, stdout=subprocess.PIPE, text=True)
    assert running.stdout.readline() == "held\n"
    yield running
    running.kill()
    running.wait()
    running.stdout.close()


def test_a_second_verb_names_the_first_and_a_dead_ones_lock_is_free(
    call_here, tmp_path, made, holder
):
    done = call_here("angles", EXAMPLE, "--out", "out")
    assert_one_sentence(*done)
    assert f"process {holder.pid} works on this folder" in done.stderr
    assert list((tmp_path / "out").iterdir()) == []
    holder.kill()
    holder.wait()
    began = time.monotonic()
    assert call_here("angles", EXAMPLE, "--out", "out").status == 0
    assert time.monotonic() - began < 120.0
    assert read(tmp_path / "out") == made


def test_no_artifact_contains_a_path_of_this_machine(tmp_path, made):
    for content in made.values():
        assert str(PROJECT).encode() not in content
        assert str(Path.home()).encode() + b"/" not in content
