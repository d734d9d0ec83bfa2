"""What can be read off a Python file.

To parse all files of a stage takes a second or two, which every command would wait for. So what was
read is kept, under the hash of a file's content.
"""

from __future__ import annotations

import ast
import hashlib
from collections.abc import Iterator
from functools import cache
from pathlib import Path
from typing import NamedTuple

from softfinger.provenance.kept import look_up


class Import(NamedTuple):
    """One imported name."""

    module: str  # begins with dots if it is relative
    name: str | None  # in that module; None: the module itself
    called: str  # what the file calls it


class Syntax(NamedTuple):
    """A file's code, and what it uses.

    Attributes
    ----------
    digest
        SHA-256 of its code without docstrings.
    imports
        What it imports, at any depth.
    used
        Names that the code of an ``__init__.py`` reads.
    groups
        Groups of entry points that it loads.
    takes_all
        Whether it imports all modules of its package.
    passes_on
        Whether it is an ``__init__.py``, which may import a name only for others.
    """

    digest: str
    imports: tuple[Import, ...]
    used: frozenset[str]
    groups: tuple[str, ...]
    takes_all: bool
    passes_on: bool


@cache
def read_syntax(path: Path) -> Syntax:
    """Read a Python file."""
    content, passes_on = path.read_bytes(), path.name == "__init__.py"
    key = hashlib.sha256(content + bytes([passes_on])).hexdigest()
    kept = look_up(key, lambda: _parse(content.decode("utf-8"), passes_on=passes_on))
    digest, imports, used, groups, takes_all, passes_on = kept
    imported = tuple(Import(*one) for one in imports)
    return Syntax(digest, imported, frozenset(used), tuple(groups), takes_all, passes_on)


def list_neighbours(path: Path) -> list[str]:
    """Modules of a file's package that it imports by listing them."""
    files = path.parent.glob("[!_]*.py") if read_syntax(path).takes_all else ()
    return sorted(file.stem for file in files)


def _parse(text: str, *, passes_on: bool) -> list:
    """Fields of a file's `Syntax`, as JSON has them."""
    tree = ast.parse(text)
    statements = [tree, *_list_statements(tree)]
    for node in statements:
        _drop_docstring(node)
    return [
        hashlib.sha256(ast.dump(tree).encode()).hexdigest(),
        [list(item) for node in statements for item in _read_import(node)],
        sorted(_list_names(tree)) if passes_on else [],
        [g for call in _find_calls(text, tree, "entry_points") for g in _read_groups(call)],
        bool(_find_calls(text, tree, "iter_modules")),
        passes_on,
    ]


def _list_statements(tree: ast.AST) -> Iterator[ast.AST]:
    """Every statement that runs, at any depth."""
    for node in ast.iter_child_nodes(tree):
        if isinstance(node, ast.If) and _is_for_checkers(node.test):
            continue
        if isinstance(node, ast.stmt | ast.excepthandler | ast.match_case):
            yield node
            yield from _list_statements(node)


def _is_for_checkers(test: ast.expr) -> bool:
    return "TYPE_CHECKING" in (getattr(test, "id", None), getattr(test, "attr", None))


def _find_calls(text: str, tree: ast.AST, name: str) -> list[ast.Call]:
    """Calls of a function, looked for by name first."""
    nodes = ast.walk(tree) if name in text else ()
    return [
        node
        for node in nodes
        if isinstance(node, ast.Call) and ast.unparse(node.func).endswith(name)
    ]


def _list_names(tree: ast.AST) -> frozenset[str]:
    nodes = (node for node in ast.walk(tree) if isinstance(node, ast.Name))
    return frozenset(node.id for node in nodes if isinstance(node.ctx, ast.Load))


def _drop_docstring(node: ast.AST) -> None:
    if (
        isinstance(node, ast.Module | ast.ClassDef | ast.FunctionDef | ast.AsyncFunctionDef)
        and ast.get_docstring(node, clean=False) is not None
    ):
        node.body = node.body[1:]


def _read_import(node: ast.AST) -> Iterator[Import]:
    if isinstance(node, ast.Import):
        for alias in node.names:
            yield Import(alias.name, None, alias.asname or alias.name.partition(".")[0])
    elif isinstance(node, ast.ImportFrom):
        module = "." * node.level + (node.module or "")
        for alias in node.names:
            yield Import(module, alias.name, alias.asname or alias.name)


def _read_groups(call: ast.Call) -> Iterator[str]:
    """Entry-point groups that a call names."""
    for word in call.keywords:
        if word.arg == "group" and isinstance(word.value, ast.Constant):
            yield str(word.value.value)
