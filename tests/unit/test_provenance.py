import pytest

from softfinger import provenance
from softfinger.provenance import code_hash, derive_seed, describe_run, find_modules


@pytest.fixture
def package(tmp_path, monkeypatch):
    """A toy package in which stage `one` uses `maths.add`, and `two` uses `maths.scale`."""
    root = tmp_path / "project/src/softfinger"
    files = {
        "__init__.py": "",
        "stages/__init__.py": "",
        "stages/one.py": "from softfinger.maths import add\nimport numpy\n",
        "stages/two.py": "def f():\n    from softfinger.maths import scale\n",
        "maths/__init__.py": "from softfinger.maths.add import add\n"
        "from softfinger.maths.scale import scale\n",
        "maths/add.py": '"""Add."""\nfrom softfinger.deep import base\n\n\ndef add(a):\n'
        '    """Say."""\n    return base(a) + 1\n',
        "maths/scale.py": "def scale(a):\n    return 2 * a\n",
        "deep.py": "from typing import TYPE_CHECKING\nif TYPE_CHECKING:\n"
        "    from softfinger.maths import scale\n\n\ndef base(a):\n    return a\n",
        "maths/style.css": "a",
    }
    for name, text in files.items():
        (root / name).parent.mkdir(parents=True, exist_ok=True)
        (root / name).write_text(text)
    monkeypatch.setattr(provenance, "PACKAGE", root)
    return root


def rehash(stage: str) -> str:
    for cached in ("code_hash", "_imported_modules", "_hash_code", "_parse"):
        getattr(provenance, cached).cache_clear()
    return code_hash(stage)


def edit(path, old, new):
    text = path.read_text()
    assert old in text
    path.write_text(text.replace(old, new))


def test_modules_are_followed_through_the_names_that_are_used(package):
    names = {p.relative_to(package).as_posix() for p in find_modules("softfinger.stages.one")}
    assert names == {"stages/one.py", "maths/add.py", "deep.py", "maths/style.css"}


def test_an_edit_changes_the_hash_of_the_stages_that_use_it_and_no_other(package):
    one, two = rehash("one"), rehash("two")
    edit(package / "deep.py", "return a", "return -a")
    assert rehash("one") != one
    assert rehash("two") == two
    one = rehash("one")
    edit(package / "maths/scale.py", "2 * a", "3 * a")
    assert rehash("two") != two
    assert rehash("one") == one


def test_wording_does_not_count(package):
    one = rehash("one")
    edit(package / "maths/add.py", "Say.", "Say otherwise.")
    edit(package / "maths/add.py", "return", "# why\n    return")
    assert rehash("one") == one


def test_files_that_are_no_python_count(package):
    one = rehash("one")
    (package / "maths/style.css").write_text("b")
    assert rehash("one") != one


def test_inputs_and_parameters_are_stamped(package, tmp_path):
    provenance.code_hash.cache_clear()
    file = tmp_path / "a.csv"
    file.write_text("1")
    run = describe_run("one", {"tables": [file, file], "one": file}, {"a": 1}, 7)
    file.write_text("2")
    other = describe_run("one", {"tables": [file, file], "one": file}, {"a": 2}, 7)
    assert run.inputs["tables"] != other.inputs["tables"]
    assert run.inputs["one"] != run.inputs["tables"]
    assert run.params_sha256 != other.params_sha256
    assert run.code_sha256 == other.code_sha256
    assert str(tmp_path) not in str(run.to_attrs())


def test_stages_draw_from_streams_of_their_own():
    seeds = {derive_seed(s, stage) for s in (0, 1) for stage in ("fit", "sobol")}
    assert len(seeds) == 4
