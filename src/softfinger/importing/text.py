"""Delimited text, whatever its form."""

import csv
import io
import re
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pandas as pd

from softfinger.importing.cells import classify, find_decimal
from softfinger.importing.description import DELIMITER_NAMES
from softfinger.importing.faults import ImportFault
from softfinger.importing.sheet import Sheet
from softfinger.importing.vocabulary import list_foreign_words

HEAD = 400  # lines that are looked at to find the layout
DELIMITERS = ("\t", ";", ",", "|", " ")
SPACES = r"\s+"
EASTERN = ("shift_jis", "gb18030", "euc_kr", "big5")
PAIR = re.compile(r"([^\W\d][\w.]*)\s*[=:]\s*([^=:,;\t]*[^=:,;\t\s])\s*(?:[,;\t]|$)")
"""A name with its value, as a microcontroller prints them: ``F=1.2 N``."""


def read_sheet(
    path: Path, name: Path, delimiter: str | None = None, encoding: str | None = None
) -> Sheet:
    """Read a text file as rows of text.

    Parameters
    ----------
    path, name : Path
        The file, and how it is called in messages.
    delimiter, encoding
        As declared; found from the content where not.

    Raises
    ------
    ImportFault
        It is empty, cannot be decoded, or a row has more fields than any near the beginning.
    """
    text = _decode(path.read_bytes(), name, encoding).replace("\N{MINUS SIGN}", "-")
    text = spread_pairs(text)
    lines = text[:4_000_000].splitlines()[:HEAD]
    skip = 0
    if lines and (found := re.fullmatch(r"sep=(.)", lines[0].strip().strip('"'))):
        delimiter, skip = delimiter or found[1], 1
    if not any(line.strip() for line in lines):
        raise ImportFault(f"{name}: the file is empty")
    delimiter = DELIMITER_NAMES.get(delimiter or "", delimiter) or find_delimiter(lines[skip:])
    rows = split_lines(lines[skip:], delimiter)
    width = max(len(row) for row in rows)
    cells = _read_rows(text, name, delimiter, width, skip)
    decimal = find_decimal([c for row in rows[len(rows) // 3 :] for c in row])
    if delimiter == "," and decimal == "," and '"' not in "".join(lines):
        decimal = "."
    return Sheet(name, "", cells, np.arange(len(cells)) + 1 + skip, decimal=decimal)


def _decode(content: bytes, name: Path, encoding: str | None) -> str:
    marks = {b"\xff\xfe": "utf-16", b"\xfe\xff": "utf-16", b"\xef\xbb\xbf": "utf-8-sig"}
    marked = [code for mark, code in marks.items() if content.startswith(mark)]
    if b"\0" in content[:2000] and not marked:
        raise ImportFault(
            f"{name}: it is not text; expected delimited text, .xlsx, .xls, .h5 or .nc"
        )
    eastern = (code for code in EASTERN if _is_eastern(content, code))
    for code in [encoding] if encoding else [*marked, "utf-8", *eastern, "cp1252", "latin-1"]:
        try:
            return content.decode(code)
        except (UnicodeDecodeError, LookupError):
            continue
    raise ImportFault(f"{name}: it is not text in {encoding}; type tables: {{encoding: utf-8}}")


def _is_eastern(content: bytes, code: str) -> bool:
    """Whether bytes so read contain a known word."""
    text = content[:20_000].decode(code, errors="ignore").lower()
    if not any(word in text for word in list_foreign_words()):
        return False
    try:
        content.decode(code)
    except UnicodeDecodeError:
        return False
    return True


def spread_pairs(text: str) -> str:
    r"""Make a table of lines of names with values.

    Any other text stays as it is.

    >>> spread_pairs("# run 1\nt=0 ms, F=0.1 N\nt=5 ms, F=0.2 N\nt=9 ms, F=0.2 N\n")
    't;F\n0 ms;0.1 N\n5 ms;0.2 N\n9 ms;0.2 N\n'
    """
    lines = text[:4_000_000].splitlines()[:HEAD]
    rows = [dict(PAIR.findall(line)) for line in lines]
    names = [tuple(row) for row in rows if len(row) > 1]
    usual = max(names, key=names.count, default=())
    first = next((k for k, row in enumerate(rows) if tuple(row) == usual), len(rows))
    filled = sum(bool(line.strip()) for line in lines[first:])
    if names.count(usual) < max(3, 0.8 * filled):
        return text
    rows += [dict(PAIR.findall(line)) for line in text.splitlines()[HEAD:]]
    cells = [";".join(row.get(name, "") for name in usual) for row in rows[first:]]
    return "\n".join([""] * (first - 1) + [";".join(usual), *cells]) + "\n"


def split_lines(lines: Sequence[str], delimiter: str) -> list[list[str]]:
    """Cells of lines; blanks delimit as one."""
    if delimiter in (" ", SPACES):
        return [line.split() for line in lines]
    return [[cell.strip() for cell in row] for row in csv.reader(lines, delimiter=delimiter)]


def find_delimiter(lines: Sequence[str]) -> str:
    r"""Find the delimiter of lines.

    It is the one that makes numbers, in rows of one width, of the later lines.

    >>> find_delimiter(["Zeit;Kraft", "0,1;2,5", "0,2;2,6"]), find_delimiter(["t F", "0.1  2.5"])
    (';', ' ')
    """
    later = [line for line in lines[len(lines) // 2 :] if line.strip()] or list(lines)
    tabbed = sum("\t" in line for line in later) > 0.5 * len(later)
    tried = DELIMITERS[:-1] if tabbed else DELIMITERS  # blanks are within the cells
    scores = [_score_delimiter(later, delimiter) for delimiter in tried]
    return tried[int(np.argmax(scores))]


def _score_delimiter(lines: Sequence[str], delimiter: str) -> float:
    rows = split_lines(lines, delimiter)
    widths = [len(row) for row in rows]
    width = max(set(widths), key=widths.count) if widths else 0
    kinds = [classify(cell) for row in rows if len(row) == width for cell in row]
    filled = [kind for kind in kinds if kind]
    if not filled:
        return 0.0
    numbers = filled.count("n") / len(filled)
    return numbers * widths.count(width) / len(widths) * (1.0 if width > 1 else 0.5)


def _read_rows(text: str, name: Path, delimiter: str, width: int, skip: int) -> pd.DataFrame:
    options = {"sep": SPACES if delimiter == " " else delimiter, "engine": "c"}
    try:
        cells = pd.read_csv(
            io.StringIO(text), header=None, names=range(width), dtype=str, skiprows=skip,
            keep_default_na=False, skip_blank_lines=False, skipinitialspace=True,
            index_col=False, **options,
        )  # fmt: skip
    except pd.errors.ParserError as error:
        found = re.search(r"Expected (\d+) fields in line (\d+), saw (\d+)", str(error))
        if not found:
            raise ImportFault(f"{name}: it cannot be read as a table: {error}") from None
        raise ImportFault(
            f"{name}, row {found[2]}: has {found[3]} fields; expected {found[1]}; is the delimiter "
            f"{delimiter!r}? Else type tables: {{delimiter: …}} in import.yaml"
        ) from None
    return cells.fillna("").astype(object)
