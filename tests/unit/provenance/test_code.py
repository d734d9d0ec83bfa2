"""The hash of a stage changes with the code that the stage runs, and with no other."""

import importlib
import shutil

import pytest

from softfinger.provenance import PACKAGE, PROJECT, code, find_modules

FILES = {
    "__init__.py": "",
    "stages/__init__.py": "",
    "stages/one.py": "from softfinger.maths import add\nimport numpy\n",
    "stages/two.py": "def f():\n    from softfinger.maths import scale\n",
    "stages/three.py": "from softfinger.effects import list_effects\n",
    "stages/four.py": "from softfinger.specs import list_specs\n",
    "stages/five.py": "from softfinger import maths\n",
    "maths/__init__.py": "from softfinger.maths.add import add\n"
    "from softfinger.maths.scale import scale\n",
    "maths/add.py": '"""Add."""\nfrom softfinger.deep import base\n\n\ndef add(a):\n'
    '    """Say."""\n    return base(a) + 1\n',
    "maths/scale.py": "def scale(a):\n    return 2 * a\n",
    "deep.py": "from typing import TYPE_CHECKING\nif TYPE_CHECKING:\n"
    "    from softfinger.maths import scale\n\n\ndef base(a):\n    return a\n",
    "maths/style.css": "a",
    "effects/__init__.py": "from importlib.metadata import entry_points\n"
    "from softfinger.effects import lag\nfrom softfinger.effects.tools import tool\n"
    "def list_effects():\n"
    "    return [lag.EFFECT, *(p.load() for p in entry_points(group='softfinger.effects'))]\n",
    "effects/lag.py": "EFFECT = 1\n",
    "effects/tools.py": "tool = 1\n",
    "specs/__init__.py": "import pkgutil\ndef list_specs():\n"
    "    return [m.name for m in pkgutil.iter_modules(__path__)]\n",
    "specs/a.py": "A = 1\n",
}


@pytest.fixture
def package(tmp_path, monkeypatch):
    """A toy package in which stage `one` uses `maths.add`, and `two` uses `maths.scale`."""
    root = tmp_path / "project/src/softfinger"
    for name, text in FILES.items():
        (root / name).parent.mkdir(parents=True, exist_ok=True)
        (root / name).write_text(text)
    monkeypatch.setitem(code.SOURCES, "softfinger", root.parent)
    return root


@pytest.fixture
def copy(tmp_path, monkeypatch):
    """The real package, copied."""
    root = tmp_path / "src/softfinger"
    shutil.copytree(PACKAGE, root, ignore=shutil.ignore_patterns("__pycache__"))
    monkeypatch.setitem(code.SOURCES, "softfinger", root.parent)
    return root


def list_names(*modules: str) -> set[str]:
    return {name.removeprefix("softfinger/") for name in find_modules(*modules)}


@pytest.mark.parametrize(
    ("stage", "used"),
    [
        ("one", {"maths/add.py", "deep.py", "maths/style.css"}),
        ("two", {"maths/scale.py", "maths/style.css"}),
        ("three", {"effects/__init__.py", "effects/lag.py"}),
        ("four", {"specs/__init__.py", "specs/a.py"}),
        ("five", {"maths/__init__.py", "maths/add.py", "maths/scale.py", "deep.py"}),
    ],
)
def test_modules_are_followed_through_the_names_that_are_used(package, rehash, stage, used):
    rehash(stage)
    found = list_names(f"softfinger.stages.{stage}")
    assert found - {"maths/style.css"} == {f"stages/{stage}.py", *used} - {"maths/style.css"}
    assert ("maths/style.css" in found) == any(name.startswith("maths/") for name in used)


def test_an_edit_changes_the_hash_of_the_stages_that_use_it_and_no_other(package, rehash, edit):
    one, two = rehash("one"), rehash("two")
    edit(package / "deep.py", "return a", "return -a")
    assert rehash("one") != one
    assert rehash("two") == two
    one = rehash("one")
    edit(package / "maths/scale.py", "2 * a", "3 * a")
    assert rehash("two") != two
    assert rehash("one") == one


def test_wording_does_not_count(package, rehash, edit):
    one = rehash("one")
    edit(package / "maths/add.py", "Say.", "Say otherwise.")
    edit(package / "maths/add.py", "return", "# why\n    return")
    assert rehash("one") == one


def test_files_that_are_no_python_count(package, rehash):
    one = rehash("one")
    (package / "maths/style.css").write_text("b")
    assert rehash("one") != one


def test_several_programs_are_hashed_together_and_a_missing_one_is_named(package, rehash):
    assert rehash("one", "two") not in {rehash("one"), rehash("two")}
    with pytest.raises(ModuleNotFoundError, match="stages\\.none"):
        rehash("none")


def test_plug_ins_count_with_what_they_import_of_their_own(package, tmp_path, monkeypatch, rehash):
    before = rehash("three"), rehash("one")
    info = tmp_path / "site/mine-1.0.dist-info"
    info.mkdir(parents=True)
    (info / "METADATA").write_text("Metadata-Version: 2.1\nName: mine\nVersion: 1.0\n")
    (info / "entry_points.txt").write_text("[softfinger.effects]\na = mine.effect:EFFECT\n")
    own = tmp_path / "site/mine"
    own.mkdir()
    (own / "__init__.py").write_text("raise RuntimeError('hashing must not import')\n")
    (own / "effect.py").write_text("from .law import law\nimport numpy\n")
    (own / "law.py").write_text("law = 1\n")
    monkeypatch.syspath_prepend(str(tmp_path / "site"))
    importlib.invalidate_caches()
    announced = rehash("three")
    assert {"mine/effect.py", "mine/law.py"} <= set(find_modules("softfinger.stages.three"))
    (own / "law.py").write_text("law = 2\n")
    assert len({before[0], announced, rehash("three")}) == 3
    assert rehash("one") == before[1]


def test_an_effect_counts_wherever_models_with_effects_are_run(copy, rehash, edit):
    def hash_stages() -> list[str]:
        rehash("track")
        return [code.code_hash(s) for s in ("diagnose", "fit", "propagate", "sobol", "virtual_rig")]

    file = copy / "mechanics/effects/wire_friction.py"
    before, other = hash_stages(), code.code_hash("track")
    edit(file, "EFFECT = Effect(", "# a remark\nEFFECT = Effect(")
    edit(file, '"""Friction along the wire.', '"""Friction of the wire.')
    assert hash_stages() == before
    edit(file, "middle - 3", "middle - 4")
    assert not set(hash_stages()) & set(before)
    assert code.code_hash("track") == other


def test_concealed_effects_count_where_campaigns_are_concealed():
    for stage in ("conceal", "limit"):
        found = list_names(f"softfinger.stages.{stage}")
        assert "concealed/effects/wire_friction.py" in found
        assert "concealed/kernel.py" in found


def test_sampling_does_not_depend_on_the_search():
    found = list_names("softfinger.stages.fit")
    assert not [name for name in found if name.startswith(("mismatch/", "report/", "figures/"))]
    assert "mechanics/forward/balance.py" in found


def test_code_outside_the_package_is_followed_into_it():
    path = "benchmarks/rivals/naive_search.py"
    found = find_modules("benchmarks.rivals.naive_search")
    assert found[path] == PROJECT / path
    assert "softfinger/mechanics/effects/wire_friction.py" in found
