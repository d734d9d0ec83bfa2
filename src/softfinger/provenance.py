"""Where a result comes from: hashes of inputs, parameters, environment and of the code it used.

Snakemake does not see which modules a script imports, so :func:`code_hash` is passed to every rule
as a parameter: editing a module reruns the rules that use it, and no other. Nothing heavy is
imported, because every parse of the workflow imports this module.
"""

from __future__ import annotations

import ast
import hashlib
import json
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

from softfinger.faults import ArtifactFault

PACKAGE = Path(__file__).resolve().parent
PROJECT = PACKAGE.parents[1]


@dataclass(frozen=True)
class Provenance:
    """What is stamped on an artifact: no clock, no absolute path, nothing of the machine."""

    stage: str
    inputs: Mapping[str, str]
    params_sha256: str
    code_sha256: str
    environment_sha256: str
    seed: int

    def to_attrs(self) -> dict[str, str | int]:
        """Root attributes of an artifact."""
        attrs = dict(vars(self))
        return attrs | {"inputs": json.dumps(dict(self.inputs), sort_keys=True)}


def describe_run(
    stage: str,
    inputs: Mapping[str, Path | str | Sequence[Path | str]],
    params: Mapping[str, Any],
    seed: int,
) -> Provenance:
    """Provenance of one run of a stage.

    Parameters
    ----------
    stage : str
        Name of the stage, which is the name of its module in ``softfinger.stages``.
    inputs : Mapping
        Role → file or files that were read.
    params : Mapping
        The configuration keys that the stage uses, and only these.
    seed : int
        Root seed of the run.
    """
    return Provenance(
        stage=stage,
        inputs={role: _hash_files(files) for role, files in sorted(inputs.items())},
        params_sha256=_hash_text(json.dumps(params, sort_keys=True, default=str)),
        code_sha256=code_hash(stage),
        environment_sha256=_hash_files(PROJECT / "environment.lock"),
        seed=seed,
    )


@cache
def code_hash(stage: str) -> str:
    """SHA-256 of the code that a stage uses, directly or through other modules of this package.

    Docstrings and comments do not count, so a change of wording does not sample again. Names that
    a package's ``__init__`` merely passes on are followed to the module that defines them.

    Parameters
    ----------
    stage : str
        Module of ``softfinger.stages``.
    """
    digest = hashlib.sha256()
    for path in find_modules(f"softfinger.stages.{stage}"):
        digest.update(path.relative_to(PACKAGE).as_posix().encode())
        digest.update(_hash_code(path))
    return digest.hexdigest()


def find_modules(module: str) -> list[Path]:
    """Files of this package that a module uses, itself included, sorted.

    Files that are no Python (templates, styles) count with the modules beside them.
    """
    if _locate(module) is None:
        raise ModuleNotFoundError(f"no module '{module}' in {PACKAGE}")
    found: set[Path] = set()
    waiting = [module]
    while waiting:
        path = _locate(waiting.pop())
        if path is None or path in found:
            continue
        found.add(path)
        if path.name != "__init__.py":
            waiting += _imported_modules(path)
    data = {
        file
        for folder in {path.parent for path in found} - {PACKAGE}
        for file in folder.iterdir()
        if file.is_file() and file.suffix not in {".py", ".pyc"}
    }
    return sorted(found | data)


@cache
def _imported_modules(path: Path) -> tuple[str, ...]:
    """Modules whose names a file uses at run time."""
    found: list[str] = []
    for node in _runtime_statements(_parse(path)):
        if isinstance(node, ast.Import):
            found += [alias.name for alias in node.names if alias.name.startswith("softfinger")]
        elif isinstance(node, ast.ImportFrom) and (node.module or "").startswith("softfinger"):
            found += [_resolve_name(str(node.module), alias.name) for alias in node.names]
    return tuple(found)


def _resolve_name(module: str, name: str) -> str:
    """Module that defines a name which is imported from another one."""
    if _locate(f"{module}.{name}") is not None:
        return f"{module}.{name}"
    path = _locate(module)
    if path is not None and path.name == "__init__.py":
        for node in _parse(path).body:
            if isinstance(node, ast.ImportFrom):
                for alias in node.names:
                    if (alias.asname or alias.name) == name:
                        return _resolve_name(str(node.module), alias.name)
    return module


def _locate(module: str) -> Path | None:
    base = PACKAGE.joinpath(*module.split(".")[1:])
    for path in (base.with_suffix(".py"), base / "__init__.py"):
        if path.is_file():
            return path
    return None


def _runtime_statements(tree: ast.AST) -> Iterator[ast.AST]:
    """Every statement at any depth but those that only a type checker runs."""
    for node in ast.iter_child_nodes(tree):
        if isinstance(node, ast.If) and "TYPE_CHECKING" in ast.unparse(node.test):
            continue
        if isinstance(node, ast.stmt | ast.excepthandler | ast.match_case):
            yield node
            yield from _runtime_statements(node)


@cache
def _parse(path: Path) -> ast.Module:
    """Syntax tree of a file, its docstrings left out."""
    tree = ast.parse(path.read_text(encoding="utf-8"))
    for node in [tree, *_runtime_statements(tree)]:
        if (
            isinstance(node, ast.Module | ast.ClassDef | ast.FunctionDef | ast.AsyncFunctionDef)
            and ast.get_docstring(node, clean=False) is not None
        ):
            node.body = node.body[1:]
    return tree


@cache
def _hash_code(path: Path) -> bytes:
    """Digest of a file's code without its wording, or of all of a file that is no Python."""
    code = ast.dump(_parse(path)).encode() if path.suffix == ".py" else path.read_bytes()
    return hashlib.sha256(code).digest()


def _hash_text(text: str) -> str:
    return hashlib.sha256(text.encode()).hexdigest()


def _hash_files(files: Path | str | Sequence[Path | str]) -> str:
    """SHA-256 of a file, or of the hashes of several in their order."""
    if isinstance(files, Path | str):
        if not Path(files).is_file():
            reason = "the file does not exist; run the rule that makes it"
            raise ArtifactFault(str(files), [reason])
        with Path(files).open("rb") as stream:
            return hashlib.file_digest(stream, "sha256").hexdigest()
    return _hash_text("".join(_hash_files(file) for file in files))


def derive_seed(seed: int, stage: str) -> int:
    """Seed of a stage's own random stream, from the root seed and the stage's name.

    Examples
    --------
    >>> derive_seed(1, "fit") != derive_seed(1, "track")
    True
    """
    return int(_hash_text(f"{seed} {stage}")[:15], 16)
