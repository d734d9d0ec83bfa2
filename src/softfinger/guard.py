"""Guard: ends a command when the guard's parent ends.

All that the command started ends with it.

``python -m softfinger.guard FD COMMAND…`` runs the command in the guard's process group. FD is the
reading end of a pipe whose writing end only the parent has: when that closes, however the parent
ended, the group is ended too.
"""

import contextlib
import os
import signal
import subprocess
import sys
import threading
import time
from types import FrameType

GRACE_S = 2.0  # for a job to remove what it has half written


def main(arguments: list[str]) -> int:
    """Run a command; its exit status."""
    for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
        signal.signal(number, _ignore)  # a handler, for the command must not inherit an ignored one
    running = subprocess.Popen(arguments[1:])
    threading.Thread(target=_end_with_parent, args=(int(arguments[0]),), daemon=True).start()
    status = running.wait()
    if status < 0:  # it was killed, and its jobs may go on
        _end_group()
    return 1 if status < 0 else status


def _ignore(number: int, frame: FrameType | None) -> None:
    del number, frame


def _end_with_parent(pipe: int) -> None:
    while os.read(pipe, 1):
        pass
    _end_group()


def _end_group() -> None:
    group = os.getpgrp()
    with contextlib.suppress(ProcessLookupError):
        os.killpg(group, signal.SIGTERM)
        time.sleep(GRACE_S)
        os.killpg(group, signal.SIGKILL)  # the guard itself as well


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
