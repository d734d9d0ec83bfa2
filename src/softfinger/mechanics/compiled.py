"""Compilation with numba, cached on disk."""

import hashlib
from collections.abc import Callable
from pathlib import Path

from numba import njit

_HERE = Path(__file__).parent
_SOURCES = sorted([*_HERE.glob("*.py"), *(_HERE / "forward").glob("*.py")])
_STAMP = hashlib.sha256(b"".join(path.read_bytes() for path in _SOURCES)).hexdigest()


def compiled(function: Callable) -> Callable:
    """Compile a function at its first call; cache it for as long as no source here changes.

    Numba's own cache looks at the file of the function alone: after a change in a function that it
    calls, it would go on running the old one.
    """
    dispatcher = njit(cache=True)(function)
    if dispatcher is not function:  # it is, where NUMBA_DISABLE_JIT is set
        dispatcher._cache._cache_file._source_stamp = _STAMP
    return dispatcher
