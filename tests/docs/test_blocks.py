"""The pages' own words, run: `bash` and `python` blocks, page by page, in a folder of their own.

Blocks marked `console` need hardware, a network or hours; of them only the names are checked.
Blocks marked `text` show content.
"""

import doctest
import os
import re
import shutil
import subprocess

import pytest

from softfinger.provenance import PROJECT

DOCS = PROJECT / "docs"
BLOCK = re.compile(r"^```(\w+)\n(.*?)^```$", re.MULTILINE | re.DOTALL)
PAGES = {
    str(path.relative_to(DOCS)): path.read_text(encoding="utf-8")
    for path in sorted(DOCS.rglob("*.md"))
}
RUNS = {"bash", "python"}


def find_blocks(text, kinds):
    return [(kind, body) for kind, body in BLOCK.findall(text) if kind in kinds]


def list_cases():
    for name, text in PAGES.items():
        if find_blocks(text, RUNS):
            slow = name == "quickstart.md" or re.match(r"---\ntested: slow\n---\n", text)
            yield pytest.param(name, marks=[pytest.mark.slow] if slow else [], id=name)


@pytest.mark.parametrize("name", list(list_cases()))
def test_the_blocks_of_a_page_run(name, tmp_path, monkeypatch):
    # what a reader sees in the folder of the project; data are copied, for a page may change them
    for there in (".venv", "config"):
        (tmp_path / there).symlink_to(PROJECT / there)
    for there in ("data/example", "docs/own_effect"):
        shutil.copytree(PROJECT / there, tmp_path / there)
    monkeypatch.chdir(tmp_path)
    names: dict = {}
    for number, (kind, body) in enumerate(find_blocks(PAGES[name], RUNS)):
        if kind == "bash":
            command = ["bash", "-euo", "pipefail", "-c", body]
            done = subprocess.run(command, capture_output=True, text=True, env=os.environ)
            assert done.returncode == 0, f"{body}\n{done.stdout[-3000:]}\n{done.stderr[-3000:]}"
        else:
            run_examples(body, names, f"{name} block {number}")


def run_examples(body, names, title):
    assert ">>>" in body, f"{title} has nothing to run"
    example = doctest.DocTestParser().get_doctest(body, {}, title, title, 0)
    example.globs = names
    said: list[str] = []
    runner = doctest.DocTestRunner()
    runner.run(example, out=said.append, clear_globs=False)
    names.update(example.globs)
    assert runner.summarize(verbose=False).failed == 0, "".join(said)


def test_an_example_that_is_wrong_would_be_seen():
    with pytest.raises(AssertionError, match="Expected"):
        run_examples(">>> 1 + 1\n3\n", {}, "wrong")


def test_blocks_are_of_the_known_kinds():
    for name, text in PAGES.items():
        kinds = {kind for kind, _ in BLOCK.findall(text)}
        assert kinds <= {*RUNS, "console", "text", "yaml", "toml"}, name
        assert text.count("\n```") == 2 * len(BLOCK.findall(text)) + 2 * text.count("\n```{"), name


def test_commands_that_are_named_exist():
    makefile = (PROJECT / "Makefile").read_text(encoding="utf-8")
    targets = set(re.findall(r"^([a-z-]+):", makefile, re.MULTILINE))
    from softfinger.cli import app

    verbs = {c.name or c.callback.__name__.replace("_", "-") for c in app.registered_commands}
    verbs |= {group.name for group in app.registered_groups}
    pages = {**PAGES, "README.md": (PROJECT / "README.md").read_text(encoding="utf-8")}
    for name, text in pages.items():
        for target in re.findall(r"(?:`|^ {4}|\$ )make ([a-z-]+)", text, re.MULTILINE):
            assert target in targets, f"{name}: make {target}"
        for verb in re.findall(r"(?:`|bin/|^ {4}|\$ )softfinger ([a-z-]+)", text, re.MULTILINE):
            assert verb in verbs or verb.startswith("-"), f"{name}: softfinger {verb}"
