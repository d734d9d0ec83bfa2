"""Workbooks: every visible sheet as cells."""

from pathlib import Path

import numpy as np
import pandas as pd

from softfinger.faults import Fault
from softfinger.gate.cells import decode_rows, read_book
from softfinger.gate.child import Limits, read_in_child
from softfinger.importing.cells import find_decimal
from softfinger.importing.faults import ImportFault
from softfinger.importing.sheet import Sheet

SLOWEST = 200_000  # bytes of a workbook per second
NOT_READ = {
    "other": "it is not a sheet of cells",
    "hidden": "it is hidden; type tables: {hidden_sheets: true} to have it read",
}


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
        It is no workbook, is protected by a password, or is too large.
    """
    sheets, dropped = [], []
    try:
        for about, coded in read_in_child(read_book, str(path), hidden, limits=_allow(path)):
            if about["state"] in NOT_READ:
                dropped.append(f"{name}, sheet '{about['sheet']}': {NOT_READ[about['state']]}")
            else:
                sheets.append(_build_sheet(name, about["sheet"], about["merged"], coded))
    except Fault as fault:
        raise ImportFault(
            f"{name}: {fault}; save it without a password as .xlsx and without cells far from the "
            "others, or export its sheets as CSV"
        ) from None
    return sheets, dropped


def _allow(path: Path) -> Limits:
    """A million rows take their time."""
    patience = Limits.silence_s + path.stat().st_size / SLOWEST
    return Limits(silence_s=patience)


def _build_sheet(file: Path, name: str, merged: int, coded: np.ndarray) -> Sheet:
    rows = decode_rows(coded)
    text = [cell for row in rows[:400] for cell in row if isinstance(cell, str)]
    notes = (f"{merged} merged cells repeat the value of the first",) if merged else ()
    cells = pd.DataFrame(rows, dtype=object)
    return Sheet(file, name, cells, np.arange(len(rows)) + 1, find_decimal(text), notes)
