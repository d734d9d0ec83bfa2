"""Compilation with numba, cached on disk for as long as no compiled source here changes.

Numba's own cache looks at the file of one function alone. After a change in a function that it
calls it would go on running the old one, and after a change of a class that it takes it could not
even read its index. Here the files of the cache carry a digest of all the sources in their names;
those of other digests are removed.
"""

import hashlib
from collections.abc import Callable
from pathlib import Path

from numba import njit
from numba.core.caching import IndexDataCacheFile

_FOLDERS = (Path(__file__).parent, Path(__file__).parent / "forward")
_SOURCES = sorted(path for folder in _FOLDERS for path in folder.glob("*.py"))
_DIGEST = hashlib.sha256(b"".join(path.read_bytes() for path in _SOURCES)).hexdigest()[:16]

for _folder in _FOLDERS:
    for _file in (_folder / "__pycache__").glob("*.nb[ic]"):
        if not _file.name.startswith(_DIGEST):
            _file.unlink(missing_ok=True)


def compiled(function: Callable) -> Callable:
    """Compile a function at its first call, and remember it on disk."""
    dispatcher = njit(cache=True, nogil=True)(function)  # trials can run side by side
    if dispatcher is not function:  # it is, where NUMBA_DISABLE_JIT is set
        cache = dispatcher._cache
        name = f"{_DIGEST}.{cache._impl.filename_base}"
        cache._cache_file = IndexDataCacheFile(cache.cache_path, name, _DIGEST)
    return dispatcher
