"""The command line in this process: what a verb imports is imported once."""

import sys
from pathlib import Path
from typing import NamedTuple

import pytest

from softfinger.cli import main

EXAMPLE = Path(__file__).parents[3] / "data/example"


class Done(NamedTuple):
    """How a verb ended, and what it wrote."""

    status: int
    stdout: str
    stderr: str


@pytest.fixture
def call(monkeypatch, capsys):
    """Run the command line here; whatever goes wrong, only SystemExit leaves it."""

    def call(*arguments):
        monkeypatch.setattr(sys, "argv", ["softfinger", *map(str, arguments)])
        with pytest.raises(SystemExit) as end:
            main()
        return Done(end.value.code or 0, *capsys.readouterr())

    return call


@pytest.fixture
def call_here(call, monkeypatch, tmp_path):
    """Run the command line in an empty folder."""
    monkeypatch.chdir(tmp_path)
    return call
