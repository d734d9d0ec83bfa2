"""Machine code on disk.

There is one file for each function and each set of types.

A file is named after the digest of all that its code was made from (`digest`), so no file is ever
out of date; it is written whole or not at all, and one that is damaged is made anew.
"""

from __future__ import annotations

import glob
import pickle
import sys
import uuid
import warnings
from functools import cache, cached_property
from hashlib import sha256
from pathlib import Path
from typing import Any

from numba.core import config
from numba.core.caching import CompileResultCacheImpl, _Cache
from numba.core.dispatcher import Dispatcher
from numba.core.serialize import dumps

from softfinger.compiled.digest import digest_function

PYTHON = f"py{sys.version_info.major}{sys.version_info.minor}{getattr(sys, 'abiflags', '')}"


class SourceCache(_Cache):
    """Machine code of one function, for numba.

    The folder is the first that can be written to of: the one that NUMBA_CACHE_DIR names,
    ``__pycache__`` beside the source, the user's cache folder. Where none can, nothing is kept.
    """

    def __init__(self, dispatcher: Dispatcher) -> None:
        self._dispatcher = dispatcher
        self._enabled = True

    @cached_property
    def _impl(self) -> CompileResultCacheImpl | None:
        """Numba's own part: where code is, its bytes."""
        try:
            return CompileResultCacheImpl(self._dispatcher.py_func)
        except RuntimeError:  # no folder
            _warn_of_no_folder(self._dispatcher.py_func.__code__.co_filename)
            return None

    @property
    def cache_path(self) -> str | None:
        """The folder, or None where nothing is kept."""
        return None if self._impl is None else str(self._impl.locator.get_cache_path())

    @cached_property
    def _stem(self) -> str:
        """Beginning of this function's file names."""
        function = self._dispatcher.py_func
        name = f"{Path(function.__code__.co_filename).stem}.{function.__qualname__}"
        return name.replace("<", "").replace(">", "")

    @cached_property
    def _digest(self) -> str:
        """Digest of the function, taken late.

        A function may call one that is defined below it.
        """
        return digest_function(self._dispatcher)[:16]

    def _find_file(self, sig: object, codegen: Any) -> Path | None:  # noqa: ANN401
        """File of the code for some types."""
        types = str(sig)
        if self.cache_path is None or not self._enabled or " at 0x" in types:
            return None  # types with an address are of this process alone
        key = repr((types, codegen.magic_tuple(), config.BOUNDSCHECK))
        name = f"{self._stem}-{self._digest}.{sha256(key.encode()).hexdigest()[:16]}.{PYTHON}.nbc"
        return Path(self.cache_path) / name

    def load_overload(self, sig: object, target_context: Any) -> Any:  # noqa: ANN401
        """Code for some types, or None."""
        target_context.refresh()
        file = self._find_file(sig, target_context.codegen())
        if file is None:
            return None
        try:
            content = file.read_bytes()
        except OSError:
            return None
        if sha256(content[32:]).digest() != content[:32]:
            return None
        try:
            result = self._impl.rebuild(target_context, pickle.loads(content[32:]))
        except (ImportError, AttributeError):  # the class of an argument has moved
            return None
        # two classes of one name have types of one name
        same = result.signature.args == tuple(getattr(sig, "args", sig))
        return result if same else None

    def save_overload(self, sig: object, data: Any) -> None:  # noqa: ANN401
        """Keep new code for some types, remove older."""
        file = self._find_file(sig, data.codegen)
        if file is None or not self._impl.check_cachable(data):
            return
        content = dumps(self._impl.reduce(data))
        part = file.with_suffix(f".{uuid.uuid4().hex[:16]}.tmp")
        try:
            self._impl.locator.ensure_cache_path()
            part.write_bytes(sha256(content).digest() + content)
            part.replace(file)
            self._remove_older(file.parent)
        except OSError as error:
            part.unlink(missing_ok=True)
            warnings.warn(f"machine code could not be kept: {error}", RuntimeWarning, stacklevel=2)

    def _remove_older(self, folder: Path) -> None:
        if "locals" in self._stem:  # functions made by one other share their name
            return
        for file in folder.glob(f"{glob.escape(self._stem)}-*.nb[ic]"):
            if PYTHON in file.name and not file.name.startswith(f"{self._stem}-{self._digest}."):
                file.unlink(missing_ok=True)

    def enable(self) -> None:
        """Keep code from now on."""
        self._enabled = True

    def disable(self) -> None:
        """Keep no code from now on."""
        self._enabled = False

    def flush(self) -> None:
        """Forget all code kept for this function."""
        if self.cache_path is not None:
            for file in Path(self.cache_path).glob(f"{glob.escape(self._stem)}-{self._digest}.*"):
                file.unlink(missing_ok=True)


@cache
def _warn_of_no_folder(source: str) -> None:
    warnings.warn(
        f"the machine code of {source} is compiled again in every process, because neither its "
        "folder nor the user's cache folder can be written to: set NUMBA_CACHE_DIR to one that can",
        RuntimeWarning,
        stacklevel=2,
    )
