"""Threads of compiled loops sleep between two of them, unless the user asks for something else."""

import os
import subprocess
import sys

import pytest

PROGRAM = "import os, softfinger.compiled; print(os.environ['OMP_WAIT_POLICY'])"


@pytest.mark.parametrize(
    ("given", "there"), [({}, "passive"), ({"OMP_WAIT_POLICY": "active"}, "active")]
)
def test_threads_wait_without_work_unless_told_otherwise(given, there):
    rest = {name: value for name, value in os.environ.items() if name != "OMP_WAIT_POLICY"}
    done = subprocess.run(
        [sys.executable, "-c", PROGRAM],
        env=rest | given,
        capture_output=True,
        text=True,
        check=True,
    )
    assert done.stdout.strip() == there
