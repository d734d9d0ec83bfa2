"""CSV tables with a declared set of columns, every fault with its row and column."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pandas as pd

from softfinger.faults import TrialFault

LONGEST_HEADING_BYTES = 20_000
MISSING_WORDS = frozenset({"", "nan", "na"})


def read_text_table(path: Path) -> pd.DataFrame:
    """Read a CSV file as text, one column per heading, nothing converted.

    Raises
    ------
    TrialFault
        The file is missing, empty, not UTF-8, its rows do not have one width, or its first line
        is too long to be a heading.
    """
    if not path.is_file():
        raise TrialFault(f"{path.name}: the file {path} does not exist")
    with path.open("rb") as stream:
        # Each of a million columns would take its time.
        if len(stream.readline(LONGEST_HEADING_BYTES + 1)) > LONGEST_HEADING_BYTES:
            raise TrialFault(
                f"{path.name}: its first line has more than {LONGEST_HEADING_BYTES} bytes; "
                "expected the headings of the columns"
            )
    try:
        table = pd.read_csv(path, dtype=str, keep_default_na=False, encoding="utf-8-sig")
    except UnicodeDecodeError as error:
        raise TrialFault(f"{path.name}: byte {error.start} is not UTF-8 text") from None
    except (pd.errors.ParserError, pd.errors.EmptyDataError) as error:
        reason = " ".join(str(error).split())
        raise TrialFault(f"{path.name}: it is not a CSV table: {reason}") from None
    if not isinstance(table.index, pd.RangeIndex):
        raise TrialFault(f"{path.name}: its rows have more fields than its heading")
    table.columns = [str(column).strip() for column in table.columns]
    return table


def check_columns(
    path: Path, table: pd.DataFrame, required: Sequence[str], optional: Sequence[str] = ()
) -> None:
    """Refuse a table whose columns are not the declared ones.

    Raises
    ------
    TrialFault
        A column is missing or unknown; the message names it and what is expected.
    """
    expected = f"expected {', '.join(required)}" + (
        f" and perhaps {', '.join(optional)}" if optional else ""
    )
    missing = [column for column in required if column not in table.columns]
    unknown = [column for column in table.columns if column not in {*required, *optional}]
    if missing or unknown:
        said = [f"column '{column}' is missing" for column in missing]
        said += [f"column '{column}' is unknown" for column in unknown]
        raise TrialFault(f"{path.name}: {' and '.join(said)}; {expected}")
    if table.empty:
        raise TrialFault(f"{path.name}: it has a heading but no rows")


def to_numbers(
    path: Path, table: pd.DataFrame, column: str, *, missing_allowed: bool = False
) -> np.ndarray:
    """Convert a column of text to numbers.

    Returns
    -------
    numpy.ndarray (row,)
        Values; NaN where a cell is empty or ``nan`` and that is allowed.

    Raises
    ------
    TrialFault
        A cell is no finite number; the message names its row, counted from 2 below the heading.
    """
    text = table[column].str.strip()
    missing = text.str.lower().isin(MISSING_WORDS).to_numpy()
    values = pd.to_numeric(text.where(~missing, "nan"), errors="coerce").to_numpy(
        float, na_value=np.nan
    )
    wrong = (~missing & ~np.isfinite(values)) | (missing & (not missing_allowed))
    if wrong.any():
        row = int(np.argmax(wrong))
        raise TrialFault(
            f"{path.name}, row {row + 2}, column '{column}': is '{text.iloc[row]}'; "
            "expected a finite number"
        )
    return values


def check_times(path: Path, time: np.ndarray) -> None:
    """Refuse times that run backwards; they may stand still.

    Raises
    ------
    TrialFault
        The message names the first row at which it does.
    """
    backwards = np.diff(time) < 0
    if backwards.any():
        row = int(np.argmax(backwards)) + 1
        raise TrialFault(
            f"{path.name}, row {row + 2}, column 'time_s': time runs backwards, {time[row]:g} s "
            f"after {time[row - 1]:g} s; sort the rows or mend the clock"
        )
