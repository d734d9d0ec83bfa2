"""Recordings of others: made up for the tests, and real ones where a folder with them is there."""

from pathlib import Path

import pytest
from benchmarks import _workbook

from softfinger.importing import read_import_description, read_recordings


@pytest.fixture
def read():
    """Import a source, with keys of import.yaml."""
    return lambda source, *keys: read_recordings(Path(source), read_import_description(None, keys))


@pytest.fixture
def real(realdata):
    """Path of a real recording; the test is skipped where there is none."""

    def find(path: str) -> Path:
        if not (realdata / path).exists():
            pytest.skip(f"{realdata / path} is not there")
        return realdata / path

    return find


@pytest.fixture
def write(tmp_path):
    """Write a file of the source folder, and return the folder."""

    def put(name: str, content: str | bytes) -> Path:
        path = tmp_path / "source" / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(content if isinstance(content, bytes) else content.encode())
        return tmp_path / "source"

    return put


@pytest.fixture
def write_book(tmp_path):
    """Write a workbook of the source folder, and return the folder."""

    def put(name, sheets, hidden=(), merged=()) -> Path:
        path = tmp_path / "source" / name
        path.parent.mkdir(parents=True, exist_ok=True)
        _workbook.write_book(path, sheets, hidden, merged)
        return path.parent

    return put
