"""Delimited text, whatever its form."""

import csv
import io
import re
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pandas as pd

from softfinger.importing.cells import classify, find_decimal
from softfinger.importing.faults import ImportFault
from softfinger.importing.sheet import Sheet

HEAD = 400  # lines that are looked at to find the layout
DELIMITERS = ("\t", ";", ",", "|", " ")
SPACES = r"\s+"


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
    text = _decode(path.read_bytes(), name, encoding)
    lines = text[:4_000_000].splitlines()[:HEAD]
    skip = 0
    if lines and (found := re.fullmatch(r"sep=(.)", lines[0].strip().strip('"'))):
        delimiter, skip = delimiter or found[1], 1
    if not any(line.strip() for line in lines):
        raise ImportFault(f"{name}: the file is empty")
    delimiter = delimiter or find_delimiter(lines[skip:])
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
    for code in [encoding] if encoding else [*marked, "utf-8", "cp1252", "latin-1"]:
        try:
            return content.decode(code)
        except (UnicodeDecodeError, LookupError):
            continue
    raise ImportFault(f"{name}: it is not text in {encoding}; type tables: {{encoding: utf-8}}")


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
    scores = [_score_delimiter(later, delimiter) for delimiter in DELIMITERS]
    return DELIMITERS[int(np.argmax(scores))]


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
