"""What was read off files, kept from one process to the next.

It is one file beside the compiled modules. An entry is found by the hash of all that it was made
from, so none is ever out of date. Where the folder cannot be written to, nothing is kept.
"""

import atexit
import contextlib
import json
import sys
import uuid
from collections.abc import Callable
from functools import cache
from pathlib import Path

PYTHON = f"py{sys.version_info.major}{sys.version_info.minor}"
FILE = Path(__file__).parent / "__pycache__" / f"syntax.{PYTHON}.json"
MOST = 5000
"""Entries of a file: ten times what a version of the project has."""


def look_up(key: str, make: Callable[[], list]) -> list:
    """An entry, made where it is not kept yet."""
    entries = _open()
    if key not in entries:
        entries[key] = make()
        if not _NEW:
            atexit.register(keep)
        _NEW[key] = entries[key]
    return entries[key]


_NEW: dict[str, list] = {}


@cache
def _open() -> dict[str, list]:
    return _read(FILE)


def _read(file: Path) -> dict[str, list]:
    """Entries of a file; none where it is missing or damaged."""
    try:
        entries = json.loads(file.read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return {}
    return entries if isinstance(entries, dict) else {}


def keep() -> None:
    """Write what is new, beside what other processes have written."""
    others = _read(FILE)
    part = FILE.with_suffix(f".{uuid.uuid4().hex[:16]}.tmp")
    with contextlib.suppress(OSError):
        FILE.parent.mkdir(exist_ok=True)
        part.write_text(json.dumps((others if len(others) < MOST else {}) | _NEW), encoding="utf-8")
        part.replace(FILE)
