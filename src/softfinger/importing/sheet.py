"""A sheet of cells, and its tables."""

import re
from collections.abc import Collection, Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from softfinger.campaign.units import is_unit
from softfinger.importing.cells import classify, find_cell_unit, find_sentinels, read_numbers
from softfinger.importing.faults import ImportFault
from softfinger.importing.headings import (
    Layout,
    find_layout,
    join_levels,
    make_unique,
    split_heading,
)
from softfinger.importing.table import RawTable

HEAD = 400  # rows that are looked at to find the layout
UNITS = re.compile(r"(?i)(?<![a-z])(units?|einheit(en)?)(?![a-z])")  # of a row above the headings


@dataclass(frozen=True, eq=False)
class Sheet:
    """All cells of a sheet; `row` counts from 1."""

    file: Path
    name: str
    cells: pd.DataFrame
    row: np.ndarray
    decimal: str = "."
    notes: tuple[str, ...] = field(default=())


def split_tables(
    sheet: Sheet, headings: Collection[int] = (), missing: Collection[str] = ()
) -> list[RawTable]:
    """Tables of a sheet.

    There is more than one where its headings are repeated further down.

    Parameters
    ----------
    sheet : Sheet
    headings
        Numbers of the heading rows, where declared.
    missing
        Words that are gaps.

    Returns
    -------
    list of RawTable
        Empty where there is no table of numbers.
    """
    grid = sheet.cells.head(HEAD).to_numpy(dtype=object).tolist()
    offset = int(sheet.row[0]) if len(sheet.row) else 1
    layout = find_layout(grid, [number - offset for number in headings])
    if layout is None:
        return []
    tables = []
    for first, last, above in _cut_blocks(sheet, grid, layout):
        table = _build_table(sheet, grid, layout, slice(first, last), missing)
        tables.append(table if above is None else _rename(table, above))
    return tables


def _cut_blocks(
    sheet: Sheet, grid: list[list[Any]], layout: Layout
) -> Iterator[tuple[int, int, str | None]]:
    """First, last row of blocks; words above them."""
    end = len(sheet.cells)
    if not layout.headings:
        yield layout.first, end, None
        return
    lowest = layout.headings[-1]
    heading = [str(cell).strip() for cell in grid[lowest]]
    at = int(np.argmax([bool(cell) for cell in heading]))
    same = sheet.cells.iloc[:, at].astype(str).str.strip().to_numpy() == heading[at]
    repeats = [r for r in np.flatnonzero(same) if r > layout.first and _matches(sheet, r, heading)]
    starts = [layout.first, *(r + layout.first - lowest for r in repeats)]
    usual = _count_numbers(sheet, layout.first)
    ends = [*(_find_end(sheet, r, usual) for r in repeats), end]
    titles = [None, *(_find_title(sheet, r) for r in repeats)]
    if len(repeats):
        titles[0] = _find_title(sheet, layout.headings[0])
    yield from zip(starts, ends, titles, strict=True)


def _matches(sheet: Sheet, row: int, heading: list[str]) -> bool:
    return [str(cell).strip() for cell in sheet.cells.iloc[row]][: len(heading)] == heading


def _find_end(sheet: Sheet, row: int, usual: int) -> int:
    """End of a block: rows of words, and of few numbers with words, aside.

    `usual` is how many numbers its first row has.
    """
    while row > 0:
        kinds = [classify(cell) for cell in sheet.cells.iloc[row - 1]]
        if kinds.count("n") > (0.5 * usual if "t" in kinds else 0):
            break
        row -= 1
    return int(row)


def _count_numbers(sheet: Sheet, row: int) -> int:
    return [classify(cell) for cell in sheet.cells.iloc[row]].count("n")


def _find_title(sheet: Sheet, row: int) -> str:
    """Single words right above a heading."""
    if row == 0:
        return ""
    above = [str(cell).strip() for cell in sheet.cells.iloc[row - 1] if str(cell).strip()]
    return above[0] if len(above) == 1 else ""


def _rename(table: RawTable, title: str) -> RawTable:
    stated = {**table.stated, "title": (title or f"row {table.row[0]}", "")}
    return RawTable(**{**vars(table), "stated": stated})


def _build_table(
    sheet: Sheet, grid: list[list[Any]], layout: Layout, rows: slice, missing: Collection[str]
) -> RawTable:
    width = sheet.cells.shape[1]
    levels = [
        [str(c).strip() for c in grid[r]] + [""] * (width - len(grid[r])) for r in layout.headings
    ]
    levels = [_strip_comment(level) for level in levels]
    levels, frames = _drop_scorer(levels)
    names, groups = join_levels(levels) if levels else ([""] * width, [""] * width)
    top = layout.headings[0] if layout.headings else layout.first
    units = [""] * width
    if layout.units is not None:
        units = _list_units(grid[layout.units])
    elif above := [row for row in grid[:top] if len(row) > 2 and UNITS.search(str(row[0]))]:
        units = ["", *_list_units(above[-1])[1:], *units][:width]
    split = [split_heading(name) for name in names]
    unique = make_unique([name for name, _ in split], groups)
    if frames:
        unique[0] = "frame"
    cells = sheet.cells.iloc[rows].reset_index(drop=True)
    cells.columns = unique
    row = sheet.row[rows]
    cells, row, dropped = _drop_text_rows(cells, row, sheet.decimal, missing)
    _refuse_long_rows(sheet, cells, row, [name for name, _ in split])
    cells, gone = _drop_empty_columns(cells)
    unit = {n: u or s[1] for n, u, s in zip(unique, units, split, strict=True) if u or s[1]}
    unit |= {c: u for c in cells if c not in unit and (u := find_cell_unit(cells[c]))}
    marks, said = _list_sentinels(cells, sheet.decimal)
    missing, dropped = (*missing, *marks), [*dropped, *said]
    return RawTable(
        sheet.file, sheet.name, cells, row, unit,
        {n: g for n, g in zip(unique, groups, strict=True) if g},
        read_preamble(grid[:top]), sheet.decimal, (*sheet.notes, *dropped, *gone), tuple(missing),
    )  # fmt: skip


def _list_units(row: list[Any]) -> list[str]:
    stated = [str(cell).strip().strip("[]()（）") for cell in row]
    return [unit if is_unit(unit) else "" for unit in stated]


def _list_sentinels(cells: pd.DataFrame, decimal: str) -> tuple[list[str], list[str]]:
    """Numbers that are gaps, as text, and sentences on them."""
    marks, said = [], []
    for column in cells:
        values = read_numbers(cells[column], "", decimal)[0]
        for mark in find_sentinels(values):
            count = int((values == mark).sum())
            marks.append(f"{mark:g}")
            said.append(f"column '{column}': {mark:g}, in {count} rows, is read as a gap")
    return list(dict.fromkeys(marks)), said


def _strip_comment(level: list[str]) -> list[str]:
    """Heading without its mark of a comment."""
    if level and level[0] in ("#", "%", "//"):
        return [*level[1:], ""]
    return [level[0].lstrip("#% ") or level[0], *level[1:]] if level else level


def _drop_scorer(levels: list[list[str]]) -> tuple[list[list[str]], bool]:
    """Heading rows of DeepLabCut without the network; whether so."""
    if not levels or levels[-1][0] != "coords":
        return levels, False
    kept = [["", *level[1:]] for level in levels if level[0] != "scorer"]
    return kept, True


def _drop_text_rows(
    cells: pd.DataFrame, row: np.ndarray, decimal: str, missing: Collection[str]
) -> tuple[pd.DataFrame, np.ndarray, list[str]]:
    """Drop blank rows, and all below the numbers."""
    filled = (cells.astype(str).to_numpy() != "").any(axis=1)
    numbers = np.zeros(len(cells), bool)
    words = None
    for column in cells:
        if numbers.all():
            break
        values, wrong = read_numbers(cells[column], "", decimal, missing)
        if words is None and np.isfinite(values).mean() > 0.5:
            words = wrong
        numbers |= np.isfinite(values)
    numbers &= True if words is None else ~words
    last = int(np.flatnonzero(numbers)[-1]) if numbers.any() else -1
    keep = filled & (np.arange(len(cells)) <= last)
    below = filled & ~keep
    dropped = []
    if below.any():
        dropped.append(f"{int(below.sum())} rows of words below row {row[last]}")
    return cells[keep].reset_index(drop=True), row[keep], dropped


def _refuse_long_rows(sheet: Sheet, cells: pd.DataFrame, row: np.ndarray, names: list[str]) -> None:
    """Refuse text with rows beyond the headings.

    A few rows go on beyond them. A workbook has remarks there, and is not refused.
    """
    named = [k for k, name in enumerate(names) if name]
    if sheet.name or not named or named[-1] + 1 == len(names):
        return
    beyond = (cells.iloc[:, named[-1] + 1 :].astype(str) != "").to_numpy()
    long = beyond.any(axis=1)
    if long.any() and not long.all():
        at = int(np.argmax(long))
        count = named[-1] + 2 + int(np.flatnonzero(beyond[at])[-1])
        raise ImportFault(
            f"{sheet.file}, row {row[at]}: has {count} fields; its heading has {named[-1] + 1}; "
            "correct the row, or type tables: {delimiter: …} in import.yaml"
        )


def _drop_empty_columns(cells: pd.DataFrame) -> tuple[pd.DataFrame, list[str]]:
    empty = [c for c in cells if (cells[c].astype(str) == "").all()]
    named = [c for c in empty if not c.startswith("column ")]
    return cells.drop(columns=empty), [f"column '{c}': it is empty" for c in named]


def read_preamble(rows: list[list[Any]]) -> dict[str, tuple[Any, str]]:
    """What is stated above a table.

    It is key → (value, unit).

    >>> read_preamble([["Area [mm^2]", 3.1, ""], ["# Sample: A12"], ["just words"]])
    {'Area': (3.1, 'mm^2'), 'Sample': ('A12', '')}
    """
    stated: dict[str, tuple[Any, str]] = {}
    for row in rows:
        filled = [cell for cell in row if str(cell).strip()]
        if len(filled) == 1 and isinstance(filled[0], str) and ":" in filled[0]:
            filled = [part.strip() for part in filled[0].lstrip("#% ").split(":", 1)]
        if len(filled) < 2 or not isinstance(filled[0], str):
            continue
        key, unit = split_heading(filled[0].lstrip("#% ").rstrip(":= "))
        more = str(filled[2]).strip("[]() ") if len(filled) == 3 else ""
        stated.setdefault(key, (filled[1], unit or more))
    return stated
