"""Workbooks: every visible sheet as cells."""

import datetime as dt
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
from python_calamine import (
    CalamineError,
    CalamineSheet,
    CalamineWorkbook,
    SheetTypeEnum,
    SheetVisibleEnum,
)

from softfinger.importing.cells import find_decimal
from softfinger.importing.faults import ImportFault
from softfinger.importing.sheet import Sheet


def read_sheets(path: Path, name: Path, *, hidden: bool = False) -> tuple[list[Sheet], list[str]]:
    """Read the sheets of a workbook.

    Parameters
    ----------
    path, name : Path
        The file, and how it is called in messages.
    hidden : bool
        Whether hidden sheets are read too.

    Returns
    -------
    sheets : list of Sheet
    dropped : list of str
        Sentences on sheets that are not read.

    Raises
    ------
    ImportFault
        It is no workbook, or protected by a password.
    """
    try:
        return _read_book(CalamineWorkbook.from_path(str(path)), name, hidden)
    except (CalamineError, OSError) as error:
        raise ImportFault(
            f"{name}: it cannot be read as a workbook ({error}); save it without a password as "
            ".xlsx, or export its sheets as CSV"
        ) from None


def _read_book(book: CalamineWorkbook, name: Path, hidden: bool) -> tuple[list[Sheet], list[str]]:
    sheets, dropped = [], []
    for about in book.sheets_metadata:
        if about.typ != SheetTypeEnum.WorkSheet:
            dropped.append(f"{name}, sheet '{about.name}': it is not a sheet of cells")
        elif about.visible != SheetVisibleEnum.Visible and not hidden:
            dropped.append(
                f"{name}, sheet '{about.name}': it is hidden; type tables: {{hidden_sheets: true}} "
                "to have it read"
            )
        else:
            sheets.append(_read_sheet(book.get_sheet_by_name(about.name), name))
    return sheets, dropped


def _read_sheet(sheet: CalamineSheet, name: Path) -> Sheet:
    rows = sheet.to_python(skip_empty_area=False)
    merged = _fill_merged(sheet, rows)
    cells = pd.DataFrame(rows, dtype=object)
    text = [cell for row in rows[:400] for cell in row if isinstance(cell, str)]
    notes = (f"{merged} merged cells repeat the value of the first",) if merged else ()
    return Sheet(name, sheet.name, cells, np.arange(len(rows)) + 1, find_decimal(text), notes)


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
