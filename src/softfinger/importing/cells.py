"""Cells: numbers, moments, gaps and words."""

import datetime as dt
import re
from collections.abc import Collection
from typing import Any

import numpy as np
import pandas as pd

from softfinger.campaign.units import find_factor, is_unit
from softfinger.faults import Fault

GAPS = frozenset(
    {"", "nan", "na", "n/a", "null", "none", "-", "--", "---", "–", "—", "?", "nat", "<null>"}
    | {"inf", "-inf", "ovld", "ovl", "overload", "overflow", "overrange", "over range", "ol"}
    | {"o.l.", "missing", "not found"}
    | {"#n/a", "#na", "#div/0!", "#value!", "#ref!", "#num!", "#name?", "#null!"}
)
SPACERS = "'\N{RIGHT SINGLE QUOTATION MARK}\N{NO-BREAK SPACE}\N{NARROW NO-BREAK SPACE}"
"""Marks between thousands that are no decimal mark anywhere."""
NUMBER = re.compile(
    rf"[+-]?(\d{{1,3}}(?:[{SPACERS}]\d{{3}})+(?:[.,]\d+)?|\d+([.,]\d+)*[.,]?|[.,]\d+)([eE][+-]?\d+)?"
)
WITH_UNIT = re.compile(rf"({NUMBER.pattern})\s*([^\d\s.,;:+\-][^\d]*)")
MOMENT = re.compile(
    r"(\d{4}[-/.]\d{1,2}[-/.]\d{1,2}|\d{1,2}[-/.]\d{1,2}[-/.]\d{2,4})([T ]\d{1,2}:\d{2}.*)?"
    r"|\d{1,3}:\d{2}(:\d{2})?([.,]\d+)?( ?[AP]M)?"
)
MOMENTS = (dt.datetime, dt.date, dt.time, dt.timedelta)
THOUSANDS = re.compile(r"[+-]?\d{1,3}([.,]\d{3})+")
SENTINELS = frozenset(
    sign * value for sign in (-1.0, 1.0) for value in (999.0, 9999.0, 99999.0, 999.9, 9999.9, 1e30)
)
"""Numbers that loggers write for a gap."""
FAR = 20.0
"""How far beyond all other numbers of its column a sentinel is."""


def classify(cell: Any) -> str:  # noqa: ANN401 (a cell of a workbook is anything)
    """Kind of a cell.

    It is ``n`` for a number or moment, ``t`` for text, and empty for a gap.

    >>> [classify(cell) for cell in ("1,5", "12 mm", "2026-03-01 10:00", "-", "Time [s]", 3.0)]
    ['n', 'n', 'n', '', 't', 'n']
    """
    if not isinstance(cell, str):
        gap = cell is None or (isinstance(cell, float) and np.isnan(cell))
        return "" if gap else "n"
    text = cell.strip()
    if text.lower() in GAPS or not text.strip("-=_–—"):
        return ""
    if NUMBER.fullmatch(text) or MOMENT.fullmatch(text):
        return "n"
    found = WITH_UNIT.fullmatch(text)
    return "n" if found and is_unit(found[5]) else "t"


def find_decimal(cells: Collection[str]) -> str:
    """Decimal mark of numbers that are text.

    Where both occur in a number the last one counts; groups of three digits alone are thousands
    beside numbers that have a point.

    >>> find_decimal(["0,5", "12"]), find_decimal(["1,234.5"]), find_decimal(["1.234,5"])
    (',', '.', ',')
    """
    numbers = [text for cell in cells if NUMBER.fullmatch(text := cell.strip())]
    both = [text for text in numbers if "," in text and "." in text]
    if both:
        return max(",.", key=both[0].rfind)
    points, commas = ([t for t in numbers if mark in t] for mark in ".,")
    if commas and (not points or not all(THOUSANDS.fullmatch(text) for text in commas)):
        return "," if len(commas) > len(points) else "."
    return "."


def read_numbers(
    cells: pd.Series, unit: str, decimal: str, missing: Collection[str] = ()
) -> tuple[np.ndarray, np.ndarray]:
    """Numbers of a column, in its unit.

    Parameters
    ----------
    cells : Series (row,)
        Text or numbers; a number may bear a unit of its own.
    unit : str
        Unit of the column, into which such numbers are turned; empty = unknown.
    decimal : str
        Decimal mark of numbers that are text.
    missing
        Words that are gaps here, beside the usual ones.

    Returns
    -------
    values (row,) float
        NaN in a gap.
    wrong (row,) bool
        Where there is something that is no number.
    """
    numbers = [float(word) for word in missing if is_float(word)]
    if cells.dtype.kind in "fiu":
        values = cells.to_numpy(float)
        return np.where(np.isin(values, numbers), np.nan, values), np.zeros(len(cells), bool)
    is_text = np.ones(len(cells), bool)
    if pd.api.types.infer_dtype(cells, skipna=False) != "string":
        is_text = np.array([isinstance(cell, str) for cell in cells], dtype=bool)
    text = cells.where(is_text, "").astype(str).str.strip()
    gap = np.array(text.str.lower().isin(GAPS | {word.strip().lower() for word in missing}))
    plain = _drop_thousands(text, decimal)
    values = np.array(pd.to_numeric(plain.where(~gap), errors="coerce"), dtype=float)
    other = ~is_text
    if other.any():
        values[other] = [_to_float(cell) for cell in cells[other]]
    gap[other] = [classify(cell) == "" for cell in cells[other]]
    gap |= np.isin(values, numbers)
    values[gap] = np.nan
    wrong = ~gap & ~np.isfinite(values)
    rows = np.flatnonzero(wrong & is_text)
    # Wrong cells are mostly alike: a heading or a word that a logger repeats.
    codes, words = pd.factorize(text.iloc[rows])
    read = np.array([_read_with_unit(word, unit, decimal) for word in words], dtype=float)
    values[rows] = read[codes]
    return values, ~gap & ~np.isfinite(values)


def is_float(word: str) -> bool:
    """Whether a word is a plain number."""
    try:
        return bool(np.isfinite(float(word)))
    except ValueError:
        return False


def find_sentinels(values: np.ndarray) -> list[float]:
    """Numbers of a column (row,) that are gaps.

    They are some that loggers write, and lie far beyond all others.

    >>> find_sentinels(np.array([0.1, -999.0, 0.3])), find_sentinels(np.array([900.0, 999.0]))
    ([-999.0], [])
    """
    seen = values[np.isfinite(values)]
    odd = np.isin(seen, list(SENTINELS))
    if not odd.any() or odd.all():
        return []
    reach = FAR * np.abs(seen[~odd]).max()
    return [float(value) for value in np.unique(seen[odd]) if abs(value) > reach]


def _drop_thousands(text: pd.Series, decimal: str) -> pd.Series:
    group = "." if decimal == "," else ","
    if text.str.contains(f"[{SPACERS}]").any():
        text = text.str.replace(rf"(?<=\d)[{SPACERS}](?=\d{{3}}(?!\d))", "", regex=True)
    if text.str.contains(group, regex=False).any():
        grouped = text.str.fullmatch(rf"[+-]?\d{{1,3}}(?:\{group}\d{{3}})+(?:\{decimal}\d*)?")
        text = text.where(~grouped, text.str.replace(group, "", regex=False))
    return text.str.replace(",", ".", regex=False) if decimal == "," else text


def _to_float(cell: Any) -> float:  # noqa: ANN401
    if isinstance(cell, MOMENTS) or cell is None:
        return np.nan
    return float(cell)


def _read_with_unit(text: str, unit: str, decimal: str) -> float:
    found = WITH_UNIT.fullmatch(text)
    if not found or not is_unit(found[5]):
        return np.nan
    number = pd.to_numeric(_drop_thousands(pd.Series([found[1]]), decimal), errors="coerce")
    try:
        return float(number.iloc[0]) * find_factor(found[5], unit or found[5])
    except Fault:
        return np.nan


def find_cell_unit(cells: pd.Series) -> str:
    """Unit that a column's numbers bear themselves.

    >>> find_cell_unit(pd.Series(["12 mm", "1.3 cm"]))
    'mm'
    """
    for cell in cells.head(50):
        found = WITH_UNIT.fullmatch(cell.strip()) if isinstance(cell, str) else None
        if found and is_unit(found[5]):
            return found[5]
    return ""
