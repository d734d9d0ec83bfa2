"""Cells of workbooks, read where they can do no harm."""

import datetime as dt
import json
import resource
from collections.abc import Iterator
from typing import Any

import numpy as np
from python_calamine import (
    CalamineError,
    CalamineSheet,
    CalamineWorkbook,
    SheetTypeEnum,
    SheetVisibleEnum,
)

from softfinger.faults import Fault
from softfinger.gate.child import Message

CELL_BYTES = 16  # of an empty cell, at least
KINDS = {kind.__name__: kind for kind in (dt.datetime, dt.date, dt.time)}


def read_book(path: str, hidden: bool) -> Iterator[Message]:
    """Read the sheets of a workbook.

    Yields
    ------
    ``sheet``, its name, and ``state``: read, hidden or other. Of a sheet that is read also
    ``merged``, how many cells repeat the first of their range; its rows are JSON
    (:func:`decode_rows`).

    Raises
    ------
    Fault
        It is no workbook, is protected, or has more cells than this process has memory for.
    """
    try:
        book = CalamineWorkbook.from_path(path)
        for about in book.sheets_metadata:
            state = "read"
            if about.typ != SheetTypeEnum.WorkSheet:
                state = "other"
            elif about.visible != SheetVisibleEnum.Visible and not hidden:
                state = "hidden"
            merged, rows = 0, []
            if state == "read":
                rows, merged = _read_sheet(book.get_sheet_by_name(about.name))
            coded = json.dumps(rows, default=_encode).encode()
            yield (
                {"sheet": about.name, "state": state, "merged": merged},
                np.frombuffer(coded, np.uint8),
            )
    except (CalamineError, OSError) as error:
        raise Fault(f"it cannot be read as a workbook ({error})") from None


def decode_rows(coded: np.ndarray) -> list[list[Any]]:
    """Rows of cells from their bytes.

    >>> decode_rows(np.frombuffer(b'[["a", 1.5, ["date", "2026-01-31"]]]', np.uint8))
    [['a', 1.5, datetime.date(2026, 1, 31)]]
    """
    rows = json.loads(coded.tobytes())
    return [[_decode(cell) if isinstance(cell, list) else cell for cell in row] for row in rows]


def _encode(cell: dt.datetime | dt.date | dt.time | dt.timedelta) -> list:
    if isinstance(cell, dt.timedelta):
        return ["timedelta", cell.days, cell.seconds, cell.microseconds]
    return [type(cell).__name__, cell.isoformat()]


def _decode(cell: list) -> dt.datetime | dt.date | dt.time | dt.timedelta:
    kind, *values = cell
    return dt.timedelta(*values) if kind == "timedelta" else KINDS[kind].fromisoformat(*values)


def _read_sheet(sheet: CalamineSheet) -> tuple[list[list[Any]], int]:
    height, width = sheet.total_height, sheet.total_width
    memory = resource.getrlimit(resource.RLIMIT_AS)[0]
    if resource.RLIM_INFINITY != memory < CELL_BYTES * height * width:
        raise Fault(
            f"it has a sheet, {sheet.name!r}, of {height} rows and {width} columns, which need "
            f"more than {memory / 2**30:g} GiB of memory"
        )
    rows = sheet.to_python(skip_empty_area=False)
    return rows, _fill_merged(sheet, rows)


def _fill_merged(sheet: CalamineSheet, rows: list[list[Any]]) -> int:
    """Repeat merged ranges' first cells; return how many."""
    filled = 0
    for (top, left), (bottom, right) in sheet.merged_cell_ranges or []:
        value = rows[top][left] if top < len(rows) and left < len(rows[top]) else ""
        if value == "" or isinstance(value, dt.time):
            continue
        for r in range(top, min(bottom + 1, len(rows))):
            for c in range(left, min(right + 1, len(rows[r]))):
                filled += (r, c) != (top, left)
                rows[r][c] = value
    return filled
