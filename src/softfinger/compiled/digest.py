"""The digest of what machine code depends on."""

from __future__ import annotations

import dis
import enum
import sys
from collections.abc import Callable, Iterator
from functools import cache
from hashlib import sha256
from types import CodeType, FunctionType, ModuleType

import llvmlite
import numba
import numpy as np
from numba.core import types
from numba.core.dispatcher import Dispatcher
from numba.core.extending import _Intrinsic

LIBRARIES = {"numba", "numpy", "scipy", "llvmlite"} | sys.stdlib_module_names
"""Their code changes with their version only."""
VERSIONS = (numba.__version__, llvmlite.__version__, np.__version__)
SCALARS = (int, float, complex, str, bytes, type(None), np.generic, np.dtype, enum.Enum, types.Type)


def digest_function(function: Callable) -> str:
    """SHA-256 of a function and of all it uses.

    That is its module, name and bytecode, without docstrings and places in a file; the functions
    that it calls, and those that they call; the constants and the fields of the classes that any
    of them uses.

    Parameters
    ----------
    function
        A Python function or one that is compiled.

    Raises
    ------
    TypeError
        A global or a constant is of a kind whose content cannot be read.
    """
    reader = _Reader()
    reader.describe(function)
    digest = sha256(repr(VERSIONS).encode())
    for part in reader.read():
        digest.update(part.encode() + b"\0")
    return digest.hexdigest()


class _Reader:
    """Describes functions; those they call wait in turn."""

    def __init__(self) -> None:
        self.numbers: dict[int, int] = {}  # id of a function → its number
        self.waiting: list[Callable] = []

    def read(self) -> Iterator[str]:
        while self.waiting:
            function = self.waiting.pop()
            if isinstance(function, Dispatcher):
                yield repr(sorted(function.targetoptions.items()))
                function = function.py_func
            yield f"{function.__module__}.{function.__qualname__}"  # machine code asks for it
            yield repr(_describe_code(function.__code__, function.__doc__))
            yield self.describe((function.__defaults__, function.__kwdefaults__))
            for name, value in _list_used(function):
                try:
                    yield f"{name} = {self.describe(value)}"
                except TypeError as error:
                    place = f"{function.__module__}.{function.__qualname__}"
                    raise TypeError(f"{place} uses {name}: {error}") from None

    def describe(self, value: object) -> str:
        match value:
            case Dispatcher() | FunctionType():
                return self._describe_function(value)
            case _Intrinsic():
                return self._describe_function(value._defn)
            case tuple() | list():
                return f"{type(value).__qualname__}({', '.join(map(self.describe, value))})"
            case dict():
                pairs = [f"{key!r}: {self.describe(item)}" for key, item in value.items()]
                return f"dict({', '.join(pairs)})"
            case np.ndarray():
                return f"{value.dtype} {value.shape} {sha256(value.tobytes()).hexdigest()}"
            case ModuleType():
                return f"module {value.__name__}"
            case type():
                return self._describe_class(value)
        if isinstance(value, SCALARS):
            return f"{type(value).__qualname__} {value!r}"
        if _is_library(type(value).__module__):
            return str(getattr(value, "__name__", type(value).__qualname__))
        raise TypeError(f"no digest can be taken of a {type(value).__qualname__}, so pass it")

    def _describe_function(self, function: Callable) -> str:
        if _is_library(function.__module__):
            return f"{function.__module__}.{function.__qualname__}"
        if id(function) not in self.numbers:
            self.numbers[id(function)] = len(self.numbers)
            self.waiting.append(function)
        return f"function {self.numbers[id(function)]}"

    def _describe_class(self, face: type) -> str:
        place = f"class {face.__module__}.{face.__qualname__}"
        if _is_library(face.__module__):
            return place
        if issubclass(face, enum.Enum):
            return f"{place} {[(member.name, member.value) for member in face]}"
        fields = [
            f"{key}: {self.describe(kind) if isinstance(kind, type) else kind}"
            for key, kind in getattr(face, "__annotations__", {}).items()
        ]
        return f"{place} ({', '.join(fields)})"


@cache
def _describe_code(code: CodeType, doc: str | None = None) -> tuple:
    constants = [
        _describe_code(constant) if isinstance(constant, CodeType)
        else sorted(map(repr, constant)) if isinstance(constant, frozenset)
        else constant
        for constant in code.co_consts
    ]  # fmt: skip
    if doc is not None and code.co_consts[0] == doc:
        constants[0] = None
    names = (code.co_names, code.co_varnames, code.co_freevars, code.co_cellvars)
    return code.co_code, constants, names, code.co_argcount, code.co_flags


def _list_used(function: FunctionType) -> Iterator[tuple[str, object]]:
    """Globals and cells that a function uses."""
    for name, cell in zip(function.__code__.co_freevars, function.__closure__ or (), strict=True):
        yield name, cell.cell_contents
    for path in _list_globals(function.__code__):
        if path[0] not in function.__globals__:
            continue  # a builtin
        value, place = function.__globals__[path[0]], path[0]
        for name in path[1:]:
            if not isinstance(value, ModuleType) or _is_library(value.__name__):
                break
            value, place = getattr(value, name), f"{place}.{name}"
        yield place, value


@cache
def _list_globals(code: CodeType) -> tuple[tuple[str, ...], ...]:
    """Globals that code loads, with attributes it takes."""
    found: dict[tuple[str, ...], None] = {}
    path: tuple[str, ...] = ()
    for step in dis.get_instructions(code):
        if step.opname == "LOAD_ATTR" and path:
            path = (*path, step.argval)
            continue
        if path:
            found[path] = None
        path = (step.argval,) if step.opname == "LOAD_GLOBAL" else ()
    for constant in code.co_consts:
        if isinstance(constant, CodeType):
            found |= dict.fromkeys(_list_globals(constant))
    return tuple(found)


def _is_library(module: str | None) -> bool:
    return (module or "builtins").split(".")[0] in LIBRARIES
