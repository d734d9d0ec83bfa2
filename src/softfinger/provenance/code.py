"""The code that a stage runs, and its hash.

Snakemake does not see which modules a script imports, so :func:`code_hash` is passed to every rule
as a parameter: editing a module reruns the rules that use it, and no other.
"""

import hashlib
from collections.abc import Iterator
from functools import cache
from importlib.metadata import EntryPoint, entry_points
from importlib.util import find_spec, resolve_name
from pathlib import Path

from softfinger.provenance.syntax import Syntax, list_neighbours, read_syntax

PACKAGE = Path(__file__).resolve().parents[1]
INSTALLED = PACKAGE / "project"  # where a wheel contains them (pyproject.toml)
PROJECT = INSTALLED if INSTALLED.is_dir() else PACKAGE.parents[1]
"""Folder of workflow, configuration, profiles and lock: the checkout, or the wheel's own."""
SOURCES = {"softfinger": PACKAGE.parent, "benchmarks": PROJECT}
"""Top-level package → folder that contains it. Code of others changes with the environment."""


@cache
def code_hash(*programs: str) -> str:
    """SHA-256 of the code that stages use.

    Effects that other packages add by entry points count where the catalogue is used. Docstrings
    and comments do not, so a change of wording does not sample again.

    Parameters
    ----------
    *programs
        Names of stages, or full names of modules.

    Raises
    ------
    ModuleNotFoundError
        There is no such stage or module.
    """
    names = [name if "." in name else f"softfinger.stages.{name}" for name in programs]
    digest = hashlib.sha256()
    for label, path in find_modules(*names).items():
        digest.update(label.encode())
        digest.update(_hash_file(path))
    return digest.hexdigest()


def find_modules(*modules: str) -> dict[str, Path]:
    """Files that modules use.

    The modules themselves are included. Each file is named by its place in its package.

    Names that the ``__init__`` of a package merely passes on are followed to the module that
    defines them; what its own code uses counts. Files that are no Python (templates, styles) count
    with the modules beside them.
    """
    sources = dict(SOURCES)
    found: dict[str, Path] = {}
    waiting = [(module, False) for module in modules]
    seen = set()
    while waiting:
        module, whole = waiting.pop()
        if (module, whole) in seen:
            continue
        seen.add((module, whole))
        path = _locate(module, sources)
        if path is None:
            if module in modules:
                raise ModuleNotFoundError(f"no module '{module}' in {PROJECT}")
            continue
        found[path.relative_to(sources[_get_top(module)]).as_posix()] = path
        syntax = read_syntax(path)
        package = module if syntax.passes_on else module.rpartition(".")[0]
        waiting += _follow_imports(syntax, package, sources, whole=whole)
        waiting += [(f"{module}.{name}", False) for name in list_neighbours(path)]
        waiting += [(name, False) for name in _find_plug_ins(syntax, sources)]
    return dict(sorted((found | _find_data(found)).items()))


def _follow_imports(
    syntax: Syntax, package: str, sources: dict[str, Path], *, whole: bool
) -> Iterator[tuple[str, bool]]:
    """A file's imports; whether all passed on counts."""
    for use in syntax.imports:
        if not syntax.passes_on or whole or use.called in syntax.used:
            yield _resolve(_make_absolute(use.module, package), use.name, sources)


def _make_absolute(module: str, package: str) -> str:
    return resolve_name(module, package) if module.startswith(".") else module


def _resolve(module: str, name: str | None, sources: dict[str, Path]) -> tuple[str, bool]:
    """Module that defines a name another offers."""
    if name is None or name == "*":
        return module, True
    if _locate(f"{module}.{name}", sources) is not None:
        return f"{module}.{name}", True
    path = _locate(module, sources)
    if path is not None and path.name == "__init__.py":
        for use in read_syntax(path).imports:
            if use.called == name:
                return _resolve(_make_absolute(use.module, module), use.name, sources)
    return module, False


def _find_plug_ins(syntax: Syntax, sources: dict[str, Path]) -> Iterator[str]:
    """Plug-ins of the groups a file asks for."""
    for group in syntax.groups:
        for point in _list_points(group):
            top = _get_top(point.module)
            spec = find_spec(top)
            if spec is not None and spec.has_location and spec.origin:
                origin = Path(spec.origin)
                package = spec.submodule_search_locations is not None
                sources.setdefault(top, origin.parents[1] if package else origin.parent)
                yield point.module


@cache
def _list_points(group: str) -> tuple[EntryPoint, ...]:
    return tuple(entry_points(group=group))


def _find_data(found: dict[str, Path]) -> dict[str, Path]:
    folders = {path.parent: label.rpartition("/")[0] for label, path in found.items()}
    return {
        f"{label}/{file.name}": file
        for folder, label in folders.items()
        if label not in {"", *SOURCES}
        for file in folder.iterdir()
        if file.is_file() and file.suffix not in {".py", ".pyc"}
    }


def _locate(module: str, sources: dict[str, Path]) -> Path | None:
    folder = sources.get(_get_top(module))
    return None if folder is None else _locate_below(folder, module)


@cache
def _locate_below(folder: Path, module: str) -> Path | None:
    base = folder.joinpath(*module.split("."))
    places = (base.with_suffix(".py"), base / "__init__.py")
    return next((path for path in places if path.is_file()), None)


def _get_top(module: str) -> str:
    return module.partition(".")[0]


@cache
def _hash_file(path: Path) -> bytes:
    """Digest of code without wording, or all bytes."""
    if path.suffix == ".py":
        return bytes.fromhex(read_syntax(path).digest)
    return hashlib.sha256(path.read_bytes()).digest()
