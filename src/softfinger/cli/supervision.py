"""One run per folder, and no process left behind."""

from __future__ import annotations

import fcntl
import hashlib
import os
import signal
import subprocess
import sys
import tempfile
import time
from contextlib import suppress
from pathlib import Path
from types import FrameType

from softfinger.faults import Fault
from softfinger.processes import is_running

WAIT_S, GRACE_S = 20.0, 10.0
_held: dict[Path, int] = {}  # folder → file descriptor, for the life of this process


def hold_folder(folder: Path) -> Path:
    """Take a folder of results for this process alone.

    The lock is an open file outside the folder: it ends with the process and what it started,
    however they end. One that is still ending is waited for.

    Raises
    ------
    Fault
        Another process works on the folder; the message names it.
    """
    place = folder.absolute().resolve()
    digest = hashlib.sha256(os.fsencode(place)).hexdigest()[:20]
    file = Path(tempfile.gettempdir()) / f"softfinger-{digest}.lock"
    if place in _held:
        return folder
    try:
        descriptor = os.open(file, os.O_RDWR | os.O_CREAT, 0o666)
    except OSError:
        return folder  # nowhere to note it
    until = time.monotonic() + WAIT_S
    while not _try(descriptor):
        holder = os.pread(descriptor, 20, 0).decode("ascii", "replace").strip()
        if time.monotonic() > until or (holder.isdigit() and is_running(int(holder))):
            os.close(descriptor)
            raise Fault(
                f"{folder}: process {holder or 'unknown'} works on this folder; wait for its end, "
                "or choose another folder"
            )
        time.sleep(0.1)
    _held[place] = descriptor
    with suppress(OSError):  # a full disk has no room for the number; the lock counts all the same
        os.ftruncate(descriptor, 0)
        os.pwrite(descriptor, f"{os.getpid()}\n".encode(), 0)
    return folder


def run_to_end(command: list[str]) -> int:
    """Run a command; no process outlives this one.

    Returns its exit status. No Python that it starts takes modules from the folder in which it
    works: what lies there is data.

    Raises
    ------
    KeyboardInterrupt
        This process was asked to end, by Ctrl-C, SIGTERM or SIGHUP; the command was ended first.
    """
    reading, writing = os.pipe()
    guarded = [sys.executable, "-P", "-m", "softfinger.guard", str(reading), *command]
    running = subprocess.Popen(
        guarded,
        pass_fds=[reading, *_held.values()],
        start_new_session=True,
        env=os.environ | {"PYTHONSAFEPATH": "1"},
    )
    os.close(reading)
    told: list[float] = []  # when

    def end(number: int, frame: FrameType | None) -> None:
        del number, frame
        told.append(time.monotonic())
        _signal_group(running, signal.SIGTERM)

    numbers = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)
    before = {number: signal.signal(number, end) for number in numbers}
    try:
        while running.poll() is None:
            if told and time.monotonic() > told[0] + GRACE_S:
                _signal_group(running, signal.SIGKILL)
            time.sleep(0.05)
    finally:
        _signal_group(running, signal.SIGKILL)
        os.close(writing)
        for number, handler in before.items():
            signal.signal(number, handler)
    if told:
        raise KeyboardInterrupt
    return running.returncode if running.returncode >= 0 else 1


def _signal_group(running: subprocess.Popen, number: int) -> None:
    """Send a signal to a process and its children.

    Its group has its own number.
    """
    try:
        os.killpg(running.pid, number)
    except (ProcessLookupError, PermissionError):
        return


def _try(descriptor: int) -> bool:
    try:
        fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        return False
    return True
