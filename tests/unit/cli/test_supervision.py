"""However a run ends, what it started ends with it, and its folder is free again."""

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from softfinger.cli.supervision import hold_folder
from softfinger.faults import Fault

# A command whose child ignores Ctrl-C, as a job in a library's code may.
COMMAND = """\
import os, signal, subprocess, sys, time
child = subprocess.Popen([sys.executable, "-c",
    "import signal, time; signal.signal(signal.SIGINT, signal.SIG_IGN); time.sleep(300)"])
open(sys.argv[1], "w").write(f"{os.getpid()} {child.pid}\\n")
time.sleep(300)
"""
RUN = """\
import sys
from pathlib import Path
from softfinger.cli.supervision import hold_folder, run_to_end
hold_folder(Path(sys.argv[2]))
try:
    sys.exit(run_to_end([sys.executable, "-c", sys.argv[1], sys.argv[2] + "/pids"]))
except KeyboardInterrupt:
    sys.exit(130)
"""


@pytest.fixture
def started(tmp_path):
    """A run in its own session, and the processes that it started."""
    running = subprocess.Popen(
        [sys.executable, "-c", RUN, COMMAND, str(tmp_path)], start_new_session=True
    )
    pids = tmp_path / "pids"
    while not (pids.exists() and pids.read_text().endswith("\n")):
        assert running.poll() is None
        time.sleep(0.02)
    yield running, [int(pid) for pid in pids.read_text().split()]
    running.kill()
    running.wait()


def wait_for_end(pids):
    for _ in range(600):
        if not any(is_running(pid) for pid in pids):
            return
        time.sleep(0.05)
    raise AssertionError(f"{[pid for pid in pids if is_running(pid)]} go on")


def is_running(pid):
    try:
        state = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0]
    except OSError:
        return False
    return state != "Z"


@pytest.mark.parametrize("number", [signal.SIGKILL, signal.SIGTERM, signal.SIGHUP, signal.SIGINT])
def test_a_signal_to_the_run_alone_ends_all_that_it_started(started, tmp_path, number):
    running, pids = started
    os.kill(running.pid, number)
    assert running.wait() == (-9 if number == signal.SIGKILL else 130)
    wait_for_end(pids)
    hold_folder(tmp_path)  # free again


def test_a_killed_command_is_no_success(started):
    running, pids = started
    os.kill(pids[0], signal.SIGKILL)
    assert running.wait() == 1
    wait_for_end(pids)


def test_a_second_run_is_told_who_has_the_folder(started, tmp_path):
    with pytest.raises(Fault, match=f"process {started[0].pid} works on this folder"):
        hold_folder(tmp_path)
