"""Counts of words in documents, messages and docstrings.

``python -m benchmarks.words`` prints a table of the documents' sentences, of the sentences that
users meet in the program's strings (messages, help, reports, labels), of the docstrings' first
lines, and of words that we avoid. Where a limit is missed, it lists the texts to mend and ends
with 1. Words are counted between blanks. A formula, a piece of code or a placeholder counts as one.
"""

from __future__ import annotations

import ast
import re
import sys
from collections.abc import Callable, Iterable, Iterator, Sequence
from itertools import chain
from pathlib import Path
from statistics import median
from typing import NamedTuple

PROJECT = Path(__file__).resolve().parents[1]
LONGEST_SENTENCE = 30
LONGEST_LINE = 9
SHORTEST_MESSAGE = 4
"""Words of a string that is a sentence; a shorter one is a label, a key or a piece."""
SHOWN = 10
"""Texts that are listed where a limit is missed."""
AVOIDED = ("stands", "holds", "says", "tells", "hangs on", "in earnest")
"""Literary words; "is", "contains", "states", "shows" and "depends on" are plainer."""
CODE = re.compile(
    r"\A---.*?^---"  # front matter
    r"|^ *```.*?^ *```|^\$\$.*?^\$\$|<!--.*?-->"  # blocks of code, formulas, comments
    r"|(?<=\n\n)(?: {4}[^\n]*\n)+",  # indented code
    re.M | re.S,
)
LINES = re.compile(r"^\s*[|#].*?$|#[ ].*?$", re.M)
"""Rows of tables, headings and comments."""
BREAKS = re.compile(r"\n\s*\n|^\s*(?:[-*]|\d+\.)\s", re.M)
ENDS = re.compile(r"(?<=[.!?])[\"*)_]*\s+(?=[^a-z])")
ATOMS = re.compile(r"`[^`]*`|\$[^$]*\$")
"""Code and formulas inside a sentence: each counts as one word."""


class Text(NamedTuple):
    """A sentence of a document or of a string, a docstring or its first line."""

    file: str
    words: str

    @property
    def length(self) -> int:
        """Number of words between blanks."""
        return len(self.words.split())


class Figure(NamedTuple):
    """A measured figure and its limit (None: only shown)."""

    name: str
    value: float
    limit: float | None = None
    texts: Sequence[Text] = ()
    """The texts to mend where the limit is missed, the worst first."""

    @property
    def is_missed(self) -> bool:
        """Whether the figure is above its limit."""
        return self.limit is not None and self.value > self.limit


def list_sentences(markdown: str) -> Iterator[str]:
    """Sentences of a document without code blocks, tables and headings."""
    prose = LINES.sub("\n\n", CODE.sub("\n\n", markdown))
    prose = re.sub(r"\]\([^)]*\)", "]", ATOMS.sub("X", prose))
    for paragraph in BREAKS.split(prose):
        for sentence in ENDS.split(" ".join(paragraph.split())):
            if re.search(r"[a-z]{2}", sentence):
                yield sentence


def list_lines(markdown: str) -> Iterator[str]:
    """Rows of tables, headings and comments of a file."""
    for line in LINES.findall(CODE.sub("\n\n", markdown)):
        yield ATOMS.sub("X", line).strip()


def list_docstrings(source: str) -> Iterator[str]:
    """Docstrings of a module and of its classes, functions and methods."""
    kinds = (ast.Module, ast.ClassDef, ast.FunctionDef, ast.AsyncFunctionDef)
    nodes = (node for node in ast.walk(ast.parse(source)) if isinstance(node, kinds))
    yield from filter(None, map(ast.get_docstring, nodes))


def list_messages(source: str) -> Iterator[str]:
    """Sentences in the strings of a module, labels and pieces included.

    Docstrings, regular expressions and lists of words (``"a b".split()``) are no messages.
    """
    for text in _list_strings(ast.parse(source)):
        if " " in text.strip():
            yield from list_sentences(text)


def _list_strings(node: ast.AST) -> Iterator[str]:
    """Strings below a node, a placeholder as ``X``."""
    below = ast.iter_child_nodes(node)
    match node:
        case ast.Expr(value=ast.Constant()):  # a docstring
            return
        case ast.Call(func=ast.Attribute(value=ast.Name(id="re"))):
            return
        case ast.Call(func=ast.Attribute(value=ast.Constant(), attr="split")):
            return
        case ast.Constant(value=str(text)):
            yield text
        case ast.JoinedStr(values=parts):
            yield "".join(p.value if isinstance(p, ast.Constant) else "X" for p in parts)
            below = (part.value for part in parts if isinstance(part, ast.FormattedValue))
    yield from chain.from_iterable(map(_list_strings, below))


def measure_words(root: Path = PROJECT) -> list[Figure]:
    """Figures of a project's words.

    Documents are README.md, CONTRIBUTING.md and docs/**/*.md; messages and docstrings are those
    in src. Avoided words count in CHANGELOG.md and in the comments of config/*.yaml, too.

    Raises
    ------
    FileNotFoundError
        The folder has no documents or no docstrings.
    """
    documents = [root / "README.md", root / "CONTRIBUTING.md", *root.glob("docs/**/*.md")]
    rows = _gather(list_lines, [*documents, *root.glob("config/*.yaml")], root)
    news = _gather(list_sentences, [root / "CHANGELOG.md"], root)
    modules = list(root.glob("src/**/*.py"))
    sentences = _gather(list_sentences, documents, root)
    strings = _gather(list_messages, modules, root)
    docstrings = _gather(list_docstrings, modules, root)
    if not sentences or not docstrings:
        raise FileNotFoundError(f"{root}: no documents or no docstrings; call it on a project")
    messages = [text for text in strings if text.length >= SHORTEST_MESSAGE]
    lines = [text._replace(words=text.words.partition("\n")[0]) for text in docstrings]
    return [
        *_measure_lengths("words of a sentence", sentences, 16, LONGEST_SENTENCE, 5),
        *_measure_lengths("words of a message", messages, 16, LONGEST_SENTENCE, 5),
        *_measure_lengths("words of a docstring's first line", lines, 9, LONGEST_LINE, None),
        *(_count(word, sentences + rows + news + strings + docstrings) for word in AVOIDED),
    ]


def _gather(split: Callable[[str], Iterator[str]], files: Iterable[Path], root: Path) -> list[Text]:
    """Texts of the files that exist."""
    there = sorted(file for file in files if file.is_file())
    names = {file: file.relative_to(root).as_posix() for file in there}
    return [Text(names[file], words) for file in there for words in split(file.read_text())]


def _measure_lengths(
    name: str, texts: list[Text], middle: float, longest: int, share: float | None
) -> Iterator[Figure]:
    """Median length, and share of the texts above a length, with their limits."""
    if not texts:
        return
    long = sorted((t for t in texts if t.length > longest), key=lambda text: -text.length)
    yield Figure(f"{name}, median", median(text.length for text in texts), middle, long)
    yield Figure(f"{name}, above {longest} [%]", 100 * len(long) / len(texts), share, long)


def _count(word: str, texts: list[Text]) -> Figure:
    pattern = re.compile(rf"\b{word}\b", re.I)
    found = [text for text in texts if pattern.search(text.words)]
    return Figure(f'"{word}"', sum(len(pattern.findall(t.words)) for t in found), 0, found)


def main(root: Path = PROJECT) -> int:
    """Print the table; 1 where a limit is missed, with the longest texts."""
    for figure in (figures := measure_words(root)):
        limit = "" if figure.limit is None else f"  at most {figure.limit}"
        print(f"{figure.name:48}{figure.value:6.4g}{limit}{'  MISSED' * figure.is_missed}")
    missed = [figure for figure in figures if figure.is_missed]
    for figure in missed:
        print(f"\n{figure.name}: {figure.value:.4g}, at most {figure.limit}. Mend first:")
        for text in figure.texts[:SHOWN]:
            print(f"{text.file}: {text.length} words: {text.words}")
    return 1 if missed else 0


if __name__ == "__main__":
    sys.exit(main(*map(Path, sys.argv[1:])))
