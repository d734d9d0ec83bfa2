"""Reading of hostile files in a limited child process.

A file may make the library that decodes it crash, hang or claim all memory. So it is read in a
process of its own, which has limits of memory and of time, and ends with its parent. What it reads
comes back as JSON, through a pipe, and as bytes, through memory that both share.
"""

import contextlib
import ctypes
import json
import mmap
import os
import resource
import select
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from importlib import import_module
from typing import IO, Any

import numpy as np

from softfinger.faults import Fault

DEATH_SIGNAL = 1  # prctl's PR_SET_PDEATHSIG

Message = tuple[Mapping[str, Any], np.ndarray]


@dataclass(frozen=True)
class Limits:
    """What a child may use."""

    memory_bytes: int = 4 << 30
    silence_s: float = 30.0  # between two messages


def read_in_child(
    worker: Callable[..., Iterator[Message]], *arguments: object, limits: Limits = Limits()
) -> Iterator[tuple[dict[str, Any], np.ndarray]]:
    """Messages of a worker that runs in a limited child.

    Parameters
    ----------
    worker : function
        A generator at the top level of a module that loads little. It yields what JSON expresses,
        and an array of bytes.
    arguments
        What JSON expresses.

    Yields
    ------
    description, bytes (uint8)

    Raises
    ------
    Fault
        The worker's own fault, or the limit that it exceeded, without the file's name.
    """
    task = json.dumps([worker.__module__, worker.__name__, arguments])
    with _open_shared() as shared:
        numbers = [str(limits.memory_bytes), str(shared.fileno()), str(os.getpid())]
        child = subprocess.Popen(
            # -P: no module comes from the folder in which somebody works
            [sys.executable, "-P", "-m", __name__, *numbers, task],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
            env=os.environ
            | {"OPENBLAS_NUM_THREADS": "1", "PYTHONPATH": os.pathsep.join(filter(None, sys.path))},
            pass_fds=[shared.fileno()],
        )
        try:
            yield from _receive(child, Segment(shared.fileno()), limits)
        finally:
            child.kill()
            child.wait()
            child.stdin.close()
            child.stdout.close()


def _open_shared() -> IO[bytes]:
    if hasattr(os, "memfd_create"):
        return os.fdopen(os.memfd_create("softfinger"), "r+b", buffering=0)
    return tempfile.TemporaryFile(buffering=0)


class Segment:
    """Memory that parent and child share; it grows."""

    def __init__(self, file: int) -> None:
        self.file = file
        self.bytes = np.empty(0, np.uint8)

    def reach(self, count: int) -> np.ndarray:
        """Its first so many bytes."""
        if count > len(self.bytes):
            os.ftruncate(self.file, count)
            self.bytes = np.frombuffer(mmap.mmap(self.file, count), np.uint8)
        return self.bytes[:count]


def _receive(
    child: subprocess.Popen, shared: Segment, limits: Limits
) -> Iterator[tuple[dict[str, Any], np.ndarray]]:
    while True:
        message = _read_line(child, limits)
        if "end" in message:
            return
        if "fault" in message:
            raise Fault(message["fault"])
        content = shared.reach(message.pop("bytes")).copy()
        with contextlib.suppress(BrokenPipeError):  # it has ended, which the next line shows
            os.write(child.stdin.fileno(), b"\n")
        yield message, content


def _read_line(child: subprocess.Popen, limits: Limits) -> dict[str, Any]:
    """Next message; the child writes no second before it is answered."""
    pipe, until, line = child.stdout.fileno(), time.monotonic() + limits.silence_s, b""
    while not line.endswith(b"\n"):
        if not select.select([pipe], [], [], max(0.0, until - time.monotonic()))[0]:
            raise Fault(
                f"reading it gave no result within {limits.silence_s:g} s; it is damaged or far "
                "too large; copy or record it again"
            )
        got = os.read(pipe, 1 << 16)
        if not got:
            raise Fault(_describe_death(child.wait(), limits))
        line += got
    return json.loads(line)


def _describe_death(status: int, limits: Limits) -> str:
    how = signal.Signals(-status).name if status < 0 else f"status {status}"
    return (
        f"reading it needs more than {limits.memory_bytes / 2**30:g} GiB of memory, or the decoder "
        f"crashes ({how}): it is damaged, or claims more than it contains; save or record it again"
    )


def main(memory: str, shared: str, parent: str, task: str) -> None:
    """Run a worker in this process, with limits.

    Its messages go to standard output; each is answered before the next is written.
    """
    pipe = os.dup(1)
    os.dup2(2, 1)  # what a library prints is no message
    _limit(int(memory), int(parent))
    segment, module, name, arguments = Segment(int(shared)), *json.loads(task)
    answered = b"\n"
    try:
        for described, content in getattr(import_module(module), name)(*arguments):
            answered = answered or os.read(0, 1)
            flat = np.ascontiguousarray(content).reshape(-1).view(np.uint8)
            segment.reach(flat.size)[:] = flat
            _send(pipe, {**described, "bytes": flat.size})
            answered = b""
        last = {"end": True}
    except Fault as fault:
        last = {"fault": str(fault)}
    answered = answered or os.read(0, 1)
    _send(pipe, last)


def _send(pipe: int, message: Mapping[str, Any]) -> None:
    line = memoryview(json.dumps(message).encode() + b"\n")
    while line:
        line = line[os.write(pipe, line) :]


def _limit(memory: int, parent: int) -> None:
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # the parent's to answer
    with contextlib.suppress(OSError, AttributeError, TypeError):  # no Linux
        ctypes.CDLL(None).prctl(DEATH_SIGNAL, signal.SIGKILL)
    if os.getppid() != parent:  # it has ended already
        os._exit(1)
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    with contextlib.suppress(ValueError, OSError):  # a system that knows no such limit
        resource.setrlimit(resource.RLIMIT_AS, (memory, memory))


if __name__ == "__main__":
    main(*sys.argv[1:])
