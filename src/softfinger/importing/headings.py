"""Where a table begins in a sheet."""

import re
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from softfinger.campaign.units import is_unit
from softfinger.importing.cells import classify

Row = Sequence[Any]
MOSTLY = 0.8  # of the rows below the first one are data
MOST_UNITS = 0.6  # of a row of units are known ones; a logger also counts segments
BRACKETS = re.compile(r"^(?P<name>.*?)\s*[\[(（](?P<unit>[^\[\]()（）]*)[\])）]\s*$")
AFTER = re.compile(r"^(?P<name>.*?\S)\s*(?:/|,|:| in )\s*(?P<unit>\S+)$")
SUFFIX = re.compile(r"^(?P<name>.*[^\W_].*?)[_ ](?P<unit>[^\W_]+|%|°C?)$")
SUFFIX_UNITS = {
    "s": "s", "sec": "s", "secs": "s", "second": "s", "seconds": "s", "ms": "ms", "us": "us",
    "ns": "ns", "min": "min", "h": "h", "hours": "h", "m": "m", "mm": "mm", "cm": "cm", "um": "um",
    "µm": "um", "rad": "rad", "deg": "deg", "degree": "deg", "degrees": "deg", "n": "N",
    "mn": "mN", "kn": "kN", "nm": "N*m", "nmm": "N*mm", "mnm": "mN*m", "pa": "Pa", "kpa": "kPa",
    "mpa": "MPa", "bar": "bar", "psi": "psi", "v": "V", "mv": "mV", "ma": "mA", "px": "pixel",
    "pixel": "pixel", "pixels": "pixel", "pct": "percent", "percent": "percent", "%": "percent",
    "°": "deg", "°c": "degC", "degc": "degC", "c": "degC", "kg": "kg", "g": "g", "hz": "Hz",
}  # fmt: skip
OF_TEMPERATURE = ("c",)  # units that are believed beside a temperature only


@dataclass(frozen=True)
class Layout:
    """Rows of a sheet, counted from 0."""

    headings: tuple[int, ...]
    units: int | None
    first: int


def find_layout(rows: Sequence[Row], headings: Sequence[int] | None = None) -> Layout | None:
    """Find the headings and the first data row.

    A column is one of numbers where most rows of the later half are numbers. Data begin at the
    first row that has no text in such columns and is followed by such rows.

    Returns
    -------
    Layout or None
        None where there is no table of numbers.
    """
    kinds = _pad([[classify(cell) for cell in row] for row in rows])
    numeric = _find_numeric_columns(kinds)
    if not numeric.any():
        return None
    like = _is_data(kinds, numeric)
    if headings:
        below = np.flatnonzero(like & (np.arange(len(rows)) > max(headings)))
        first = int(below[0]) if below.size else len(rows)
        units = first - 1 if first - 1 > max(headings) else None
        return Layout(tuple(headings), units, first)
    following = like[::-1].cumsum()[::-1] / np.maximum(_count_filled(kinds), 1)
    good = np.flatnonzero(like & _is_followed(kinds, like) & (following >= MOSTLY))
    if not good.size:
        return None
    return _find_headings(rows, kinds, numeric, int(good[0]))


def _pad(kinds: list[list[str]]) -> np.ndarray:
    width = max((len(row) for row in kinds), default=0)
    return np.array([row + [""] * (width - len(row)) for row in kinds], dtype="U1").reshape(
        len(kinds), width
    )


def _find_numeric_columns(kinds: np.ndarray) -> np.ndarray:
    filled = np.flatnonzero((kinds != "").any(axis=1))
    later = kinds[filled[len(filled) // 2 :]]
    numbers, text = (later == "n").sum(axis=0), (later == "t").sum(axis=0)
    return (numbers > text) & (numbers > 0)


def _is_data(kinds: np.ndarray, numeric: np.ndarray) -> np.ndarray:
    own = kinds[:, numeric]
    numbers = (own == "n").sum(axis=1)
    return (own != "t").all(axis=1) & (numbers > 0) & (numbers >= 0.2 * numeric.sum())


def _is_followed(kinds: np.ndarray, like: np.ndarray) -> np.ndarray:
    """Whether the next filled row, if any, is data."""
    followed = np.ones(len(kinds), bool)
    filled = np.flatnonzero((kinds != "").any(axis=1))
    followed[filled[:-1]] = like[filled[1:]]
    return followed


def _count_filled(kinds: np.ndarray) -> np.ndarray:
    """Count filled rows from each one on."""
    return (kinds != "").any(axis=1)[::-1].cumsum()[::-1]


def _find_headings(
    rows: Sequence[Row], kinds: np.ndarray, numeric: np.ndarray, first: int
) -> Layout:
    filled = [r for r in range(first - 1, max(first - 5, -1), -1) if (kinds[r] != "").any()]
    if not filled or filled[0] < first - 2 or not _is_heading(kinds[filled[0]], numeric):
        return Layout((), None, first)
    lowest, above = filled[0], filled[1:2]
    units = None
    if above and _is_unit_row(rows[lowest]) and _is_heading(kinds[above[0]], numeric):
        units, lowest = lowest, above[0]
    elif above and _count_units(rows[above[0]]) >= 2 > 2 * _count_units(rows[lowest]):
        lowest = above[0]  # between names with units and data are numbers of channels
    levels = [lowest]
    while levels[0] > 0 and _is_upper_heading(rows, kinds, levels[0], numeric):
        levels.insert(0, levels[0] - 1)
    return Layout(tuple(levels), units, first)


def _is_heading(kinds: np.ndarray, numeric: np.ndarray) -> bool:
    """Whether most columns of numbers bear text."""
    return bool((kinds == "t").any() and (kinds[numeric] != "").sum() >= 0.5 * numeric.sum())


def _is_unit_row(row: Row) -> bool:
    texts = [_strip_brackets(str(cell)) for cell in row if str(cell).strip()]
    known = [text for text in texts if is_unit(text)]
    if len(known) == len(texts):
        return bool(texts)
    sure = sum(len(text) > 1 or text in "%°" for text in known)  # one letter may be a name
    return sure >= 2 and len(known) >= MOST_UNITS * len(texts)


def _count_units(row: Row) -> int:
    return sum(bool(split_heading(str(cell))[1]) for cell in row)


def _strip_brackets(text: str) -> str:
    return text.strip().strip("[]()（）").strip()


def _is_upper_heading(
    rows: Sequence[Row], kinds: np.ndarray, lower: int, numeric: np.ndarray
) -> bool:
    """Whether the row above gives groups."""
    above = [str(cell).strip() for cell in rows[lower - 1]]
    named = [cell for cell in above if cell]
    if len(named) < 2 or (kinds[lower - 1] == "t").sum() < len(named) / 2:
        return False
    if len(set(named)) <= 0.5 * len(named) + 1:
        return len(named) >= 0.5 * numeric.sum()
    below = [str(cell).strip() for cell in rows[lower] if str(cell).strip()]
    last = max(i for i, cell in enumerate(above) if cell)
    return len(set(below)) < len(below) and last >= 0.4 * len(kinds[lower])


def split_heading(text: str) -> tuple[str, str]:
    """Split a heading into a name and unit.

    >>> split_heading("Time [h]"), split_heading("Creep Compliance (1/Pa)"), split_heading("q1_deg")
    (('Time', 'h'), ('Creep Compliance', '1/Pa'), ('q1', 'deg'))
    >>> split_heading("Timestamp (millisec since midnight today)"), split_heading("Force, N")
    (('Timestamp', 'millisec'), ('Force', 'N'))
    """
    text = " ".join(text.split())
    if (found := BRACKETS.match(text)) and found["name"]:
        words = found["unit"].split()
        for unit in (found["unit"].strip(), words[0] if words else ""):
            for spelling in (unit, unit.lower()):
                if is_unit(spelling):
                    return found["name"], spelling or "1"
        return text, ""
    if (found := AFTER.match(text)) and is_unit(found["unit"]) and found["unit"] not in "-–":
        return found["name"], found["unit"]
    if (found := SUFFIX.match(text)) and _is_suffix(found["name"], found["unit"], text):
        return found["name"], SUFFIX_UNITS[found["unit"].lower()]
    return text, ""


def _is_suffix(name: str, unit: str, text: str) -> bool:
    """Whether the last word is a unit."""
    if unit.lower() not in SUFFIX_UNITS:
        return False
    if unit.lower() in OF_TEMPERATURE:
        return "temp" in name.lower()
    if len(unit) == 1 and unit.isupper():
        return "_" in text and unit in "NV"
    return "_" in text or len(unit) > 1 or unit in "s%°"


def join_levels(levels: Sequence[Sequence[str]]) -> tuple[list[str], list[str]]:
    """Names and groups of columns from heading rows.

    The lowest row is the last.

    A blank in an upper row continues the cell to its left; an upper row that is the same all over
    is a title, and left out.

    Returns
    -------
    names, groups : list of str
        Of each column; a group is empty where there is none.

    Examples
    --------
    >>> join_levels([["T1", "", "T2", ""], ["x", "y", "x", "y"]])
    (['x', 'y', 'x', 'y'], ['T1', 'T1', 'T2', 'T2'])
    """
    if not levels:
        return [], []
    upper = []
    for level in levels[:-1]:
        filled = list(level)
        for i in range(1, len(filled)):
            filled[i] = filled[i] or filled[i - 1]
        if len({cell for cell in filled if cell}) > 1:
            upper.append(filled)
    names = [" ".join(cell.split()) for cell in levels[-1]]
    groups = [" ".join(filter(None, parts)) for parts in zip(*upper, strict=True)]
    return names, groups or [""] * len(names)


def make_unique(names: Sequence[str], groups: Sequence[str]) -> list[str]:
    """Give each column a name of its own.

    It gets its group, or a number.

    >>> make_unique(["x", "y", "x", "", "a", "a"], ["T1", "T1", "T2", "", "", ""])
    ['T1 x', 'T1 y', 'T2 x', 'column 4', 'a', 'a (2)']
    """
    given: list[str] = []
    counts: dict[str, int] = {}
    for i, (name, group) in enumerate(zip(names, groups, strict=True)):
        whole = " ".join(filter(None, (group, name))) or f"column {i + 1}"
        counts[whole] = counts.get(whole, 0) + 1
        given.append(whole if counts[whole] == 1 else f"{whole} ({counts[whole]})")
    return given
