"""The counter finds a text that is hard to read."""

from pathlib import Path

import pytest
from benchmarks import words

PLAIN = "The finger bends. It creeps under load.\n"
LONG = f"The finger {'slowly ' * 29}bends.\n"


def write_project(
    root: Path, document: str = PLAIN, first_line: str = "The angle.", code: str = ""
) -> Path:
    (root / "docs").mkdir()
    (root / "docs/page.md").write_text(document)
    (root / "src").mkdir()
    (root / "src/code.py").write_text(f'"""{first_line}"""\n{code}\n')
    return root


def measure(root: Path) -> dict[str, float]:
    return {figure.name: figure.value for figure in words.measure_words(root)}


def test_plain_text_passes(tmp_path, capsys):
    assert words.main(write_project(tmp_path)) == 0
    assert "MISSED" not in capsys.readouterr().out


@pytest.mark.parametrize(
    ("bad", "name"),
    [
        ({"document": PLAIN * 9 + LONG}, "words of a sentence, above 30"),
        ({"document": f"The finger {'slowly ' * 15}bends."}, "words of a sentence, median"),
        ({"first_line": f"The {'very ' * 8}angle."}, "words of a docstring's first line, median"),
        ({"code": f"a = {LONG!r}\nb = {PLAIN * 9!r}"}, "words of a message, above 30"),
        ({"code": f"a = 'The {'very ' * 16}angle.'"}, "words of a message, median"),
        ({"document": "It holds."}, '"holds"'),
        ({"document": PLAIN + "\n| a | it tells |\n"}, '"tells"'),
        ({"document": PLAIN + "\n# What it says\n"}, '"says"'),
        ({"code": "a = f'{place} stands {often}'"}, '"stands"'),
        ({"first_line": "What hangs on it."}, '"hangs on"'),
    ],
)
def test_bad_text_is_refused_with_its_place(tmp_path, capsys, bad, name):
    assert words.main(write_project(tmp_path, **bad)) == 1
    missed = [line for line in capsys.readouterr().out.splitlines() if line.endswith("MISSED")]
    assert len(missed) == 1
    assert missed[0].startswith(name)


def test_longest_text_is_listed_with_its_file(tmp_path, capsys):
    words.main(write_project(tmp_path, PLAIN + LONG))
    assert "docs/page.md: 32 words: The finger slowly" in capsys.readouterr().out


@pytest.mark.parametrize(
    "block",
    [
        f"```\n{LONG}```\n",
        f"\n    {LONG}",
        f"| {LONG.strip()} |\n",
        f"# {LONG}",
        f"$$\n{LONG}$$\n",
        f"<!-- {LONG}-->\n",
    ],
)
def test_code_tables_headings_and_formulas_do_not_count(tmp_path, block):
    assert measure(write_project(tmp_path, PLAIN + block))["words of a sentence, above 30 [%]"] == 0


@pytest.mark.parametrize(
    ("text", "lengths"),
    [
        ("One two. Three four five.", [2, 3]),
        ("- one two\n- three four five\n", [2, 3]),
        ("a link [to the page](docs/a b c.md) here", [6]),
        ("code `a b c` and $x + y$ here", [5]),
        ("one two\nthree, e.g. four", [5]),
    ],
)
def test_sentences(text, lengths):
    assert [len(sentence.split()) for sentence in words.list_sentences(text)] == lengths


def test_avoided_words_count_in_words_not_in_code(tmp_path):
    root = write_project(tmp_path, "It holds.\n\n`holds` is code.\n", "It holds what it says.")
    assert measure(root)['"holds"'] == 2
    assert measure(root)['"says"'] == 1


@pytest.mark.parametrize(
    ("code", "messages"),
    [
        ('"""It is a docstring."""', []),
        ("fail('one ' 'two three. Four five.')", ["one two three.", "Four five."]),
        ("fail(f'{file}, row {row:.3g}: is {value!r} here')", ["X, row X: is X here"]),
        ("f'{a} and {\"b with c\" if a else d}'", ["X and X", "b with c"]),
        ("re.compile('a pattern of words')", []),
        ("'a list of words'.split()", []),
        ("'word'", []),
    ],
)
def test_messages(code, messages):
    assert list(words.list_messages(code)) == messages


def test_avoided_words_count_in_changes_and_settings(tmp_path):
    root = write_project(tmp_path)
    (root / "CHANGELOG.md").write_text("- It says why.\n")
    (root / "config").mkdir()
    (root / "config/default.yaml").write_text("seed: 1 # tells draws apart\n")
    assert measure(root)['"says"'] == 1
    assert measure(root)['"tells"'] == 1


def test_labels_are_no_sentences(tmp_path):
    root = write_project(tmp_path, code="a = 'time of frame'\nb = 'one two three four'")
    assert measure(root)["words of a message, median"] == 4


def test_a_folder_without_texts_is_refused(tmp_path):
    with pytest.raises(FileNotFoundError, match="no documents"):
        words.measure_words(tmp_path)
