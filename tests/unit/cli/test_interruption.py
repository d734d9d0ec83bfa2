"""Ctrl-C: one sentence, exit status 130, nothing half-written."""

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

PROJECT = Path(__file__).parents[3]
EXAMPLE = str(PROJECT / "data/example")
SENTENCE = "softfinger: interrupted; what was finished is kept, what was begun is not\n"
# Ctrl-C at the very moment at which a file is read, or put in its place; a shell's background had
# switched Ctrl-C off.
CODE = """\
import signal, sys
from softfinger.cli import main
signal.signal(signal.SIGINT, signal.default_int_handler)
event, name = sys.argv.pop(1), sys.argv.pop(1)
def interrupt(now, what):
    if now == event and name in " ".join(map(str, what)):
        signal.raise_signal(signal.SIGINT)
sys.addaudithook(interrupt)
main()
"""


def interrupt(folder, event, name, *arguments):
    """Run a verb in a folder, and press Ctrl-C when an event touches a file of that name."""
    return subprocess.run(
        [sys.executable, "-c", CODE, event, name, *arguments],
        cwd=folder, capture_output=True, text=True, check=False,
    )  # fmt: skip


def list_files(folder):
    return sorted(str(path.relative_to(folder)) for path in folder.rglob("*") if path.is_file())


@pytest.mark.parametrize(
    ("verb", "arguments", "event", "name"),
    [
        ("check", [EXAMPLE], "open", "trials.csv"),
        ("angles", [EXAMPLE, "--out", "out"], "os.rename", "angles.nc"),
        ("virtual-rig", ["--out", "out"], "os.rename", "truth.nc"),
        ("run", [EXAMPLE, "--out", "out"], "open", "trials.csv"),
    ],
)
def test_ctrl_c_in_a_verb_is_one_sentence(verb, arguments, event, name, tmp_path):
    done = interrupt(tmp_path, event, name, verb, *arguments)
    assert done.stderr == SENTENCE
    assert done.returncode == 130
    assert not [path for path in list_files(tmp_path) if "partial" in path or name in path]


def test_ctrl_c_while_the_program_is_loading_is_the_same_sentence(tmp_path):
    load = CODE.replace("from softfinger.cli import main\n", "")
    load = load.replace("main()\n", "from softfinger.cli import main\nmain()\n")
    done = subprocess.run(
        [sys.executable, "-c", load, "import", "softfinger.cli.results", "check", EXAMPLE],
        cwd=tmp_path, capture_output=True, text=True, check=False,
    )  # fmt: skip
    assert (done.returncode, done.stderr) == (130, SENTENCE)


def test_ctrl_c_keeps_what_a_verb_has_finished(call_here, tmp_path):
    assert call_here("angles", EXAMPLE, "--out", "first").status == 0
    Path("first").rename("out")  # this process keeps the lock of `first`
    before = (tmp_path / "out/angles.nc").read_bytes()
    done = interrupt(tmp_path, "os.rename", "least_squares.nc", "fit", EXAMPLE, "--out", "out")
    assert (done.returncode, done.stderr) == (130, SENTENCE)
    assert list_files(tmp_path) == ["out/angles.nc", "out/doubts.nc"]
    assert (tmp_path / "out/angles.nc").read_bytes() == before


@pytest.mark.slow
def test_ctrl_c_ends_a_run_and_the_next_run_goes_on(tmp_path):
    """The terminal sends Ctrl-C to the workflow and its jobs as well."""
    command = [sys.executable, "-c", CODE, "never", "never", "run", EXAMPLE, "--out", "out"]
    running = subprocess.Popen(
        command, cwd=tmp_path, start_new_session=True, stderr=subprocess.PIPE, text=True
    )
    while not (tmp_path / "out/angles.nc").exists():
        assert running.poll() is None
        time.sleep(0.1)
    os.killpg(running.pid, signal.SIGINT)
    said = running.communicate()[1]
    assert running.returncode == 130
    assert said.endswith(SENTENCE)
    assert "Traceback" not in said
    assert not [path for path in list_files(tmp_path) if "partial" in path]
    assert subprocess.run(command, cwd=tmp_path, capture_output=True, check=False).returncode == 0
    assert (tmp_path / "out/report.html").is_file()
