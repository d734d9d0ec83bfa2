"""A table as found: columns, units, what is stated."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from softfinger.importing.cells import read_numbers
from softfinger.importing.faults import ImportFault


@dataclass(frozen=True, eq=False)
class RawTable:
    """Rows of one table, nothing converted.

    Attributes
    ----------
    file, sheet
        Where it is from; `sheet` is empty in a text file.
    cells : DataFrame (row, column)
        Text, numbers or moments; the columns have unique names.
    row : (row,)
        Number of each row in its file or sheet, from 1.
    unit, group : dict
        Column → unit, or heading above its own that it shares with others; where there is one.
    stated : dict
        What is stated above the table, key → (value, unit).
    decimal : str
        Decimal mark of numbers that are text.
    dropped : tuple
        Sentences on what was not read.
    """

    file: Path
    sheet: str
    cells: pd.DataFrame
    row: np.ndarray
    unit: dict[str, str] = field(default_factory=dict)
    group: dict[str, str] = field(default_factory=dict)
    stated: dict[str, tuple[Any, str]] = field(default_factory=dict)
    decimal: str = "."
    dropped: tuple[str, ...] = ()
    missing: tuple[str, ...] = ()

    @property
    def place(self) -> str:
        """File and sheet, for messages."""
        return f"{self.file}, sheet '{self.sheet}'" if self.sheet else str(self.file)

    @property
    def columns(self) -> list[str]:
        """Names of the columns."""
        return list(self.cells.columns)

    def take(self, rows: np.ndarray) -> RawTable:
        """Some of its rows."""
        return replace(self, cells=self.cells.iloc[rows], row=self.row[rows])

    def read(self, column: str, unit: str = "", what: str = "a number") -> np.ndarray:
        """Numbers of a column.

        Raises
        ------
        ImportFault
            There is no such column, or a cell is no number; the message names it.
        """
        if column not in self.cells:
            said = f"{self.place}: there is no column '{column}'; it has {', '.join(self.columns)}"
            raise ImportFault(said)
        unit = unit or self.unit.get(column, "")
        values, wrong = read_numbers(self.cells[column], unit, self.decimal, self.missing)
        if wrong.any():
            at = int(np.argmax(wrong))
            cell = self.cells[column].iloc[at]
            more = f" ({int(wrong.sum())} such cells)" if wrong.sum() > 1 else ""
            raise ImportFault(
                f"{self.place}, row {self.row[at]}, column '{column}': is '{cell}'{more}; expected "
                f"{what}{f' in {unit}' if unit else ''}; correct it, or type tables: "
                f"{{missing: ['{cell}']}} in import.yaml if it is a gap"
            )
        return values

    def read_leniently(self, column: str) -> np.ndarray:
        """Numbers of a column, NaN where not numbers."""
        unit = self.unit.get(column, "")
        return read_numbers(self.cells[column], unit, self.decimal, self.missing)[0]
