"""Workers that behave badly, for a child to run."""

import os
import time

import numpy as np

from softfinger.faults import Fault

NOTHING = np.empty(0, np.uint8)


def answer(sizes):
    """Messages of given sizes."""
    for number, size in enumerate(sizes):
        yield {"number": number}, np.full(size, number, np.uint8)


def refuse(before):
    """A fault of its own."""
    yield from answer([1] * before)
    raise Fault("row 3 is odd")


def crash(before):
    """The end that a failed allocation makes in compiled code."""
    yield from answer([1] * before)
    os.abort()


def grow(before):
    """More memory than is allowed."""
    yield from answer([1] * before)
    yield {"sum": int(np.ones(1 << 32, np.uint8).sum())}, NOTHING


def sleep(before):
    """No result."""
    yield from answer([1] * before)
    time.sleep(60)


def talk():
    """Prints what is no message."""
    os.write(1, b"hello\n")
    print("hello", flush=True)
    yield {"done": True}, NOTHING
