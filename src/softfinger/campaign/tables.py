"""CSV tables with a declared set of columns."""

import csv
from collections.abc import Collection, Iterator, Sequence
from pathlib import Path
from typing import BinaryIO

import numpy as np
import pandas as pd

from softfinger.faults import TrialFault, show
from softfinger.gate import find_obstacle

LONGEST_HEADING_BYTES = 20_000
PIECE_BYTES = 1 << 20
PIECE_ROWS = 200_000  # whose text is in memory at a time
MOST_ROWS = 20_000_000
# A recording lasts from a millisecond to three years, by a clock that begins with the trial.
SHORTEST_S, LATEST_S = 1e-3, 1e8
MISSING_WORDS = frozenset({"", "nan", "na"})


def read_text_table(path: Path) -> pd.DataFrame:
    """Read a CSV file as text.

    One column per heading; nothing is converted.

    Raises
    ------
    TrialFault
        The file cannot be read or is empty, is not UTF-8, contains a NUL, its headings are not
        different words, its rows do not have one width, or it is larger than any recording.
    """
    return next(_read_pieces(path, MOST_ROWS + 1))


def read_number_table(
    path: Path, required: Sequence[str], optional: Collection[str] = ()
) -> dict[str, np.ndarray]:
    """Read a CSV file of declared columns as numbers.

    Its text is never in memory as a whole. `optional` are columns whose cells may be empty.

    Returns
    -------
    dict
        Column → numpy.ndarray (row,), as of :func:`to_numbers`.

    Raises
    ------
    TrialFault
        As of :func:`read_text_table`, :func:`check_columns` and :func:`to_numbers`.
    """
    pieces: dict[str, list[np.ndarray]] = {column: [] for column in required}
    rows = 0
    for table in _read_pieces(path, PIECE_ROWS):
        if not rows:
            check_columns(path, table, required)
        for column, numbers in pieces.items():
            may_miss = column in optional
            numbers.append(
                to_numbers(path, table, column, missing_allowed=may_miss, first_row=rows)
            )
        rows += len(table)
        _refuse_too_many(path, rows)
    return {column: np.concatenate(numbers) for column, numbers in pieces.items()}


def _read_pieces(path: Path, rows: int) -> Iterator[pd.DataFrame]:
    """Pieces of a table of text; the first may be empty."""
    obstacle = find_obstacle(path)
    if obstacle:
        raise TrialFault(f"{path.name}: the file {obstacle}")
    headings = _read_headings(path)
    try:
        with pd.read_csv(
            path,
            dtype=str,
            keep_default_na=False,
            encoding="utf-8-sig",
            names=headings,
            header=0,
            chunksize=rows,
        ) as pieces:
            for table in pieces:
                # Of a second piece the index counts on.
                if not isinstance(table.index, pd.RangeIndex):
                    raise TrialFault(f"{path.name}: its rows have more fields than its heading")
                _refuse_too_many(path, len(table))
                yield table
    except UnicodeDecodeError as error:
        raise TrialFault(f"{path.name}: byte {error.start} is not UTF-8 text") from None
    except (pd.errors.ParserError, pd.errors.EmptyDataError) as error:
        reason = " ".join(str(error).split())
        raise TrialFault(f"{path.name}: it is not a CSV table: {reason}") from None


def _refuse_too_many(path: Path, rows: int) -> None:
    if rows > MOST_ROWS:
        raise TrialFault(f"{path.name}: it has more than {MOST_ROWS} rows")


def _read_headings(path: Path) -> list[str]:
    """Headings of a table: different, printable and not empty."""
    with path.open("rb") as stream:
        # Each of a million columns would take its time.
        line = stream.readline(LONGEST_HEADING_BYTES + 1)
        if len(line) > LONGEST_HEADING_BYTES:
            raise TrialFault(
                f"{path.name}: its first line has more than {LONGEST_HEADING_BYTES} bytes; "
                "expected the headings of the columns"
            )
        stream.seek(0)
        _refuse_nul(path, stream)
    try:
        text = line.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise TrialFault(f"{path.name}: byte {error.start} is not UTF-8 text") from None
    # A file of an old Macintosh ends its lines with a carriage return alone.
    rows = list(csv.reader(text.splitlines()[:1]))
    if not rows or not rows[0]:
        raise TrialFault(f"{path.name}: its first line is empty; expected headings of columns")
    headings = [heading.strip() for heading in rows[0]]
    for number, heading in enumerate(headings, start=1):
        if not heading or not heading.isprintable():
            raise TrialFault(
                f"{path.name}, column {number}: its heading is {show(heading)}; expected a word"
            )
    twice = sorted({heading for heading in headings if headings.count(heading) > 1})
    if twice:
        raise TrialFault(
            f"{path.name}: the column {show(twice[0])} appears twice; remove or rename one"
        )
    return headings


def _refuse_nul(path: Path, stream: BinaryIO) -> None:
    for number, piece in enumerate(iter(lambda: stream.read(PIECE_BYTES), b"")):
        place = piece.find(b"\0")
        if place >= 0:
            raise TrialFault(
                f"{path.name}: byte {number * PIECE_BYTES + place} is NUL; expected a text table"
            )


def check_columns(
    path: Path, table: pd.DataFrame, required: Sequence[str], optional: Sequence[str] = ()
) -> None:
    """Refuse a table with other than declared columns.

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
    path: Path,
    table: pd.DataFrame,
    column: str,
    *,
    missing_allowed: bool = False,
    first_row: int = 0,
) -> np.ndarray:
    """Convert a column of text to numbers.

    `first_row` is how many rows of the file are before the table.

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
            f"{path.name}, row {first_row + row + 2}, column '{column}': is "
            f"{show(text.iloc[row])}; expected a finite number"
        )
    return values


def check_times(path: Path, time: np.ndarray) -> None:
    """Refuse times that run backwards or are impossible.

    Equal times are allowed.

    Raises
    ------
    TrialFault
        The message names the first row at which they do.
    """
    late = np.abs(time) > LATEST_S
    if late.any():
        row = int(np.argmax(late))
        raise TrialFault(
            f"{path.name}, row {row + 2}, column 'time_s': is {time[row]:g} s; expected the time "
            f"since the trial began, at most {LATEST_S:g} s; subtract the start's "
            "stamp here and in the load log"
        )
    backwards = np.diff(time) < 0
    if backwards.any():
        row = int(np.argmax(backwards)) + 1
        raise TrialFault(
            f"{path.name}, row {row + 2}, column 'time_s': time runs backwards, {time[row]:g} s "
            f"after {time[row - 1]:g} s; sort the rows or correct the clock"
        )


def check_span(path: Path, time: np.ndarray) -> None:
    """Refuse a recording that is shorter than any trial.

    Raises
    ------
    TrialFault
        Its frames lie within a millisecond, but not at one time.
    """
    span = float(time[-1] - time[0])
    if 0.0 < span < SHORTEST_S:
        raise TrialFault(
            f"{path.name}, column 'time_s': spans {span:g} s; expected at least {SHORTEST_S:g} s; "
            "check the unit of the time"
        )
