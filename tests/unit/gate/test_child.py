"""A worker that crashes, hangs or takes too much ends in a sentence, and leaves no process."""

import os
import signal
import subprocess
import sys
import time
from importlib import import_module
from pathlib import Path

import numpy as np
import pytest

from softfinger.faults import Fault
from softfinger.gate.child import Limits, read_in_child

HERE = Path(__file__).parent


@pytest.fixture
def workers(monkeypatch):
    monkeypatch.syspath_prepend(HERE)
    return import_module("spoiled_workers")


def list_children(process: int) -> set[int]:
    """Numbers of a process's children."""
    listed = Path(f"/proc/{process}/task/{process}/children").read_text()
    return {int(number) for number in listed.split()}


@pytest.fixture
def children_before():
    """Children that an earlier test's pool of processes keeps."""
    return list_children(os.getpid())


def read(worker, *arguments, **limits):
    return list(read_in_child(worker, *arguments, limits=Limits(**limits)))


def test_messages_come_in_order_whatever_their_size(workers):
    sizes = [0, 3, 100_000, 1, 2_000_000, 0]
    messages = read(workers.answer, sizes)
    assert [described["number"] for described, _ in messages] == list(range(len(sizes)))
    for number, (size, (_, content)) in enumerate(zip(sizes, messages, strict=True)):
        np.testing.assert_array_equal(content, np.full(size, number, np.uint8))


@pytest.mark.parametrize(
    ("worker", "said"),
    [
        ("refuse", "row 3 is odd"),
        ("crash", "SIGABRT"),
        ("grow", "GiB of memory"),
        ("sleep", "no result within 1 s"),
    ],
)
@pytest.mark.parametrize("before", [0, 2])
def test_what_goes_wrong_is_one_sentence_and_no_child_is_left(
    workers, worker, said, before, children_before
):
    silence = 1.0 if worker == "sleep" else 30.0
    with pytest.raises(Fault, match=said) as caught:
        read(getattr(workers, worker), before, memory_bytes=2 << 30, silence_s=silence)
    assert "\n" not in str(caught.value)
    assert list_children(os.getpid()) <= children_before


def test_what_a_library_prints_is_no_message(workers):
    assert [described for described, _ in read(workers.talk)] == [{"done": True}]


def test_reading_can_end_early(workers, children_before):
    messages = read_in_child(workers.answer, [5] * 100)
    next(messages)
    messages.close()
    assert list_children(os.getpid()) <= children_before


def test_a_child_ends_with_its_parent():
    code = (
        "from softfinger.gate.child import read_in_child; import spoiled_workers\n"
        "messages = read_in_child(spoiled_workers.sleep, 1)\n"
        "next(messages); print('ready', flush=True)\n"
        "next(messages)"
    )
    environment = os.environ | {"PYTHONPATH": os.pathsep.join([str(HERE), *sys.path])}
    parent = subprocess.Popen(
        [sys.executable, "-c", code], env=environment, stdout=subprocess.PIPE, text=True
    )
    assert parent.stdout.readline() == "ready\n"
    (child,) = list_children(parent.pid)
    parent.send_signal(signal.SIGKILL)
    parent.communicate()
    for _ in range(100):
        if not Path(f"/proc/{child}/cmdline").exists() or not read_command(child):
            break
        time.sleep(0.05)
    assert "softfinger" not in read_command(child)


def read_command(process: int) -> str:
    try:
        return Path(f"/proc/{process}/cmdline").read_text()
    except FileNotFoundError:
        return ""
