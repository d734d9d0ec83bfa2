"""Compiled code is never older than its source, and is not compiled without need."""

import importlib
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from numba.core import caching

from softfinger.compiled import digest_function

CALLEE = '''
from typing import NamedTuple
from softfinger.compiled import compiled

LIMIT = 10.0

class Pair(NamedTuple):
    first: float
    second: float

@compiled
def add(a):
    """Add."""
    return a + 1.0

@compiled
def scale(a):
    return min(2.0 * a, LIMIT)
'''
CALLER = """
import callee
from callee import add, scale, Pair
from softfinger.compiled import compiled

@compiled
def run_add(a):
    return inner(a)

@compiled
def inner(a):
    return add(a)

@compiled
def run_scale(a):
    return scale(a)

@compiled
def run_module(a):
    return callee.add(a)

@compiled
def swap(a):
    pair = Pair(a, 0.0)
    return pair.first
"""


@pytest.fixture
def project(tmp_path, monkeypatch):
    """Two modules on the path, of which one calls the other's compiled functions."""
    (tmp_path / "callee.py").write_text(CALLEE)
    (tmp_path / "caller.py").write_text(CALLER)
    monkeypatch.syspath_prepend(str(tmp_path))
    monkeypatch.setattr(sys, "dont_write_bytecode", True)  # an edit within a second would be missed
    yield tmp_path
    forget()


def forget() -> None:
    for name in ("callee", "caller"):
        sys.modules.pop(name, None)
    importlib.invalidate_caches()


def restart():
    """Import both modules anew, as a new process would."""
    forget()
    return importlib.import_module("caller")


def edit(path: Path, old: str, new: str) -> None:
    text = path.read_text()
    assert text.count(old) == 1
    path.write_text(text.replace(old, new))


def count_compilations(function) -> int:
    return sum(function.stats.cache_misses.values())


def test_a_new_process_returns_what_an_edited_callee_returns(project):
    command = [sys.executable, "-B", "-c", "import caller; print(caller.run_add(1.0))"]
    paths = [str(project), *filter(None, [os.environ.get("PYTHONPATH")])]
    env = os.environ | {"PYTHONPATH": os.pathsep.join(paths)}

    def run() -> str:
        return subprocess.run(command, env=env, capture_output=True, text=True, check=True).stdout

    assert run() == "2.0\n"
    edit(project / "callee.py", "a + 1.0", "a + 7.0")
    assert run() == "8.0\n"


@pytest.mark.parametrize(
    ("name", "old", "new", "after"),
    [
        ("run_add", "a + 1.0", "a - 1.0", 2.0),
        ("run_module", "a + 1.0", "a - 1.0", 2.0),
        ("run_scale", "LIMIT = 10.0", "LIMIT = 5.0", 5.0),
    ],
)
def test_an_edit_far_away_compiles_the_caller_anew(project, name, old, new, after):
    assert getattr(restart(), name)(3.0) != after
    edit(project / "callee.py", old, new)
    function = getattr(restart(), name)
    assert function(3.0) == after
    assert count_compilations(function) == 1


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("LIMIT = 10.0", "LIMIT = 5.0"),  # of another function
        ('"""Add."""', '"""Add one."""\n    # why'),
        ('    """Add."""\n', ""),
        ("\nLIMIT", "\n\n\n# moved down\nLIMIT"),
    ],
)
def test_what_a_function_does_not_use_compiles_nothing(project, old, new):
    restart().run_add(3.0)
    edit(project / "callee.py", old, new)
    function = restart().run_add
    assert function(3.0) == 4.0
    assert count_compilations(function) == 0


def test_functions_and_classes_may_move_to_another_module(project):
    text = "from typing import NamedTuple\nfrom softfinger.compiled import compiled\n"
    text += "class Held(NamedTuple):\n    a: float\n@compiled\ndef shift(held):\n"
    text += "    return held.a + 1.0\n"
    (project / "caller.py").write_text(
        "import callee\nfrom softfinger.compiled import compiled\n"
        "@compiled\ndef run(held):\n    return held.a\n"
        "@compiled\ndef run_shift(held):\n    return callee.shift(held)\n"
    )
    edit(project / "callee.py", "LIMIT = 10.0", "LIMIT = 10.0\nfrom before import Held, shift")
    for name in ("before", "after"):
        (project / f"{name}.py").write_text(text)
        caller = restart()
        held = caller.callee.Held(1.0)
        assert caller.run(held) == 1.0
        assert caller.run_shift(held) == 2.0
        sys.modules.pop(name)
        (project / f"{name}.py").unlink()
        if name == "before":
            edit(project / "callee.py", "from before", "from after")


def test_fields_of_a_class_count(project):
    before = digest_function(restart().swap)
    edit(project / "callee.py", "second: float", "last: float")
    assert digest_function(restart().swap) != before


def test_types_of_one_name_are_told_apart(project):
    text = "import callee\nfrom softfinger.compiled import compiled\n"
    for name, fields in (("one", ("a", "b")), ("two", ("b", "a"))):
        text += f"class Holder_{name}(callee.NamedTuple):\n"
        text += "".join(f"    {field}: float\n" for field in fields)
        text += f"Holder_{name}.__name__ = 'Holder'\n"
    text += "@compiled\ndef read(x):\n    return x.a\n"
    (project / "caller.py").write_text(text)
    caller = restart()
    assert caller.read(caller.Holder_one(1.0, 2.0)) == 1.0
    caller = restart()
    assert caller.read(caller.Holder_two(1.0, 2.0)) == 2.0


def test_options_count(project):
    before = digest_function(restart().inner)
    edit(project / "caller.py", "@compiled\ndef inner", "@compiled(error_model='numpy')\ndef inner")
    assert digest_function(restart().inner) != before


def test_parallel_code_is_cached(project):
    (project / "caller.py").write_text(
        "from callee import scale\nfrom numba import prange\nimport numpy as np\n"
        "from softfinger.compiled import compiled\n"
        "@compiled(parallel=True)\ndef run(n):\n    total = np.zeros(n)\n"
        "    for i in prange(n):\n        total[i] = scale(i)\n    return total\n"
    )
    assert restart().run(3).tolist() == [0.0, 2.0, 4.0]
    function = restart().run
    assert function(3).tolist() == [0.0, 2.0, 4.0]
    assert count_compilations(function) == 0
    edit(project / "callee.py", "2.0 *", "3.0 *")
    assert restart().run(3).tolist() == [0.0, 3.0, 6.0]


def test_generated_functions_are_told_apart_by_what_they_enclose(project):
    (project / "caller.py").write_text(
        "from softfinger.compiled import compiled\n"
        "def build(k):\n    @compiled\n    def power(a):\n        return a**k\n    return power\n"
        "square, cube = build(2), build(3)\n"
    )
    for _ in range(2):
        caller = restart()
        assert (caller.square(2.0), caller.cube(2.0)) == (4.0, 8.0)
    assert count_compilations(caller.square) == count_compilations(caller.cube) == 0


@pytest.mark.filterwarnings("ignore:First-class function type feature")
def test_a_function_that_is_given_as_an_argument_may_change(project):
    """First-class functions: the receiver is not compiled again, and runs the new one."""
    (project / "caller.py").write_text(
        "import callee\nfrom numba import float64, types\n"
        "from softfinger.compiled import compiled\n"
        "hook = compiled(signature=float64(float64))(callee.add.py_func)\n"
        "kind = types.FunctionType(float64(float64))\n"
        "@compiled(signature=float64(types.UniTuple(kind, 2), float64))\n"
        "def run(hooks, a):\n    return hooks[0](hooks[1](a))\n"
    )
    caller = restart()
    assert caller.run((caller.hook, caller.hook), 1.0) == 3.0
    edit(project / "callee.py", "a + 1.0", "a - 1.0")
    caller = restart()
    assert caller.run((caller.hook, caller.hook), 1.0) == -1.0
    assert count_compilations(caller.run) == 0
    assert count_compilations(caller.hook) == 1


@pytest.mark.parametrize("damage", [lambda c: c[: len(c) // 2], lambda c: c[:-9] + b"x" * 9, bytes])
def test_damaged_files_are_made_anew(project, damage):
    restart().run_scale(3.0)
    for file in (project / "__pycache__").glob("caller.run_scale-*"):
        file.write_bytes(b"" if damage is bytes else damage(file.read_bytes()))
    assert restart().run_scale(3.0) == 6.0
    function = restart().run_scale
    assert function(3.0) == 6.0
    assert count_compilations(function) == 0


def test_files_of_older_sources_are_removed_and_nothing_else(project):
    restart().run_add(3.0)
    restart().run_scale(3.0)
    before = list_files(project)
    edit(project / "callee.py", "a + 1.0", "a - 1.0")
    restart().run_add(3.0)
    after = list_files(project)
    assert {name.split("-")[0] for name in before - after} == {
        "caller.run_add", "caller.inner", "callee.add"
    }  # fmt: skip
    assert len(after) == len(before)


def list_files(project: Path) -> set[str]:
    return {file.name for file in (project / "__pycache__").iterdir()}


def test_without_a_folder_for_it_code_is_compiled_each_time(project, monkeypatch):
    monkeypatch.setattr(caching.CompileResultCacheImpl, "_locator_classes", [])
    caller = restart()
    with pytest.warns(RuntimeWarning, match="NUMBA_CACHE_DIR"):
        assert caller.run_add(3.0) == 4.0
    assert not (project / "__pycache__").exists()


def test_a_read_only_installation_uses_the_users_folder(project, monkeypatch):
    class Refusing(caching.InTreeCacheLocator):
        def ensure_cache_path(self) -> None:
            raise PermissionError

    class Elsewhere(caching.UserWideCacheLocator):
        def get_cache_path(self) -> str:
            return str(project / "user")

    monkeypatch.setattr(caching.CompileResultCacheImpl, "_locator_classes", [Refusing, Elsewhere])
    assert restart().run_add(3.0) == 4.0
    assert not (project / "__pycache__").exists()
    function = restart().run_add
    assert function(3.0) == 4.0
    assert count_compilations(function) == 0


def test_a_global_that_cannot_be_read_is_refused_by_name(project):
    edit(project / "caller.py", "return add(a)", "return UNKNOWN(a)")
    edit(
        project / "caller.py", "import callee\n", "import callee\nclass Own: ...\nUNKNOWN = Own()\n"
    )
    with pytest.raises(TypeError, match=r"caller\.inner uses UNKNOWN"):
        digest_function(restart().run_add)


def test_constants_count_by_content():
    def use(table):
        return digest_function(build(table))

    def build(table):
        return lambda i: table[i]

    assert use(np.arange(3)) == use(np.arange(3))
    assert use(np.arange(3)) != use(np.arange(3.0))
    assert use((1, np.arange(3))) != use((2, np.arange(3)))
