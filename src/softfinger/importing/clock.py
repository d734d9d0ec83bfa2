"""Times of rows in seconds, from any clock."""

import datetime as dt
from functools import lru_cache
from typing import NamedTuple

import numpy as np
import pandas as pd

from softfinger.campaign.units import find_factor, is_unit
from softfinger.importing.cells import MOMENT, MOMENTS, NUMBER, classify
from softfinger.importing.faults import ImportFault
from softfinger.importing.table import RawTable
from softfinger.importing.vocabulary import CLOCK, is_alike, score_words

EXCEL_DAY_0 = dt.datetime(1899, 12, 30, tzinfo=dt.UTC)
EXCEL_DAYS = (2e4, 8e4)  # dates from 1954 to 2119
EPOCH_UNITS = ((1e17, "ns"), (1e14, "us"), (1e11, "ms"), (9e8, "s"))  # since 1970, by size
ARDUINO = {"millis": "ms", "micros": "us"}  # its clocks, and their units
MOSTLY = 0.8  # of the cells are moments; a summary below them is none


class Times(NamedTuple):
    """Times (row,) [s], NaN for gaps; moment 0."""

    seconds: np.ndarray
    zero: dt.datetime | None
    unit: str


def read_times(table: RawTable, column: str, unit: str | None = None) -> Times:
    """Read a column of times.

    Parameters
    ----------
    unit
        As declared; else the column's own, else found from the size of the numbers (stamps since
        1970, dates of a spreadsheet), else seconds.

    Raises
    ------
    ImportFault
        A cell is no time.
    """
    if column not in table.cells:
        said = f"{table.place}: there is no column '{column}'; it has {', '.join(table.columns)}"
        raise ImportFault(said)
    cells = table.cells[column]
    if _holds_moments(cells):
        return _read_moments(table, column)
    unit = unit or table.unit.get(column) or ARDUINO.get(column.lower())
    values = table.read(column, unit or "", "a time")
    seen = values[np.isfinite(values)]
    if not seen.size:
        raise ImportFault(f"{table.place}, column '{column}': it contains no time")
    if unit is None:
        return _read_stamps(values, float(np.median(seen)), column)
    factor = find_factor(unit, "s")
    zero = None
    if np.median(seen) * factor > EPOCH_UNITS[-1][0]:
        zero = dt.datetime.fromtimestamp(0, dt.UTC)
    return Times(values * factor, zero, unit)


def _read_stamps(values: np.ndarray, typical: float, column: str) -> Times:
    for size, unit in EPOCH_UNITS:
        if typical > size:
            return Times(
                values * find_factor(unit, "s"), dt.datetime.fromtimestamp(0, dt.UTC), unit
            )
    dates = score_words(column, "date datum datetime time zeit timestamp") > 0
    if (
        dates
        and EXCEL_DAYS[0] < typical < EXCEL_DAYS[1]
        and np.nanmax(values) - np.nanmin(values) < 400
    ):
        whole = values == np.round(values)
        if not whole.all():
            return Times(values * 86400.0, EXCEL_DAY_0, "d")
    return Times(values, None, "s")


def _holds_moments(cells: pd.Series) -> bool:
    filled = [cell for cell in cells.head(50) if classify(cell)]
    return sum(_is_moment(cell) for cell in filled) > MOSTLY * len(filled)


def _is_moment(cell: object) -> bool:
    if isinstance(cell, str):
        return bool(MOMENT.fullmatch(cell.strip())) and not NUMBER.fullmatch(cell.strip())
    return isinstance(cell, MOMENTS)


def _read_moments(table: RawTable, column: str) -> Times:
    """Read dates, and clock readings past midnight."""
    cells = table.cells[column]
    seconds, dated = np.full(len(cells), np.nan), False
    for row, cell in enumerate(cells):
        if classify(cell) == "" or str(cell).strip() in table.missing:
            continue
        value = _to_seconds(cell)
        if value is None:
            raise ImportFault(
                f"{table.place}, row {table.row[row]}, column '{column}': is '{cell}'; expected a "
                "date or a time of day as in the rows above; correct it, or type tables: "
                f"{{missing: ['{cell}']}} in import.yaml if the row has no time"
            )
        seconds[row], dated = value
    if dated:
        return Times(seconds, dt.datetime.fromtimestamp(0, dt.UTC), "date")
    seen = np.flatnonzero(np.isfinite(seconds))
    turns = np.cumsum(np.diff(seconds[seen], prepend=seconds[seen][:1]) < -43200.0)
    seconds[seen] += 86400.0 * turns
    return Times(seconds, None, "time of day")


def _to_seconds(cell: object) -> tuple[float, bool] | None:
    """Seconds of a moment, and whether dated."""
    if isinstance(cell, str):
        text = cell.strip().replace(",", ".")
        if ":" in text and not any(mark in text.split(":")[0] for mark in "-/."):
            try:
                parts = text if text.count(":") == 2 else f"0:{text}"
                return pd.to_timedelta(parts).total_seconds(), False
            except ValueError:
                pass
        european = text[2:3] == "."
        moment = pd.to_datetime(text, errors="coerce", dayfirst=european, utc=True)
        return None if pd.isna(moment) else (moment.timestamp(), True)
    if isinstance(cell, dt.datetime):
        moment = cell if cell.tzinfo else cell.replace(tzinfo=dt.UTC)
        return moment.timestamp(), True
    if isinstance(cell, dt.date):
        return dt.datetime(cell.year, cell.month, cell.day, tzinfo=dt.UTC).timestamp(), True
    if isinstance(cell, dt.time):
        return (
            cell.hour * 3600.0 + cell.minute * 60.0 + cell.second + 1e-6 * cell.microsecond,
            False,
        )
    if isinstance(cell, dt.timedelta):
        return cell.total_seconds(), False
    return None


@lru_cache(maxsize=1024)
def list_clocks(table: RawTable) -> tuple[tuple[str, str], ...]:
    """Clock columns, best first: ``time`` or ``frame``."""
    found = []
    for place, column in enumerate(table.columns):
        scores = {kind: score_words(column, words) for kind, words in CLOCK.items()}
        unit = table.unit.get(column, "")
        timed = is_alike(unit, "s")
        if unit and not timed and is_unit(unit) and not is_alike(unit, "1"):
            continue  # T [°C] is no time
        kind = "frame" if scores["frame"] > scores["time"] and not timed else "time"
        score = max(scores.values()) + 1.5 * timed
        moments = _holds_moments(table.cells[column])
        if score + moments <= 0 and column not in (
            "column 1",
            "index",
            "sample",
            "Index",
            "Sample",
        ):
            continue
        if not moments and not _is_running(table.read_leniently(column)):
            continue
        near = 0.0 if moments else _starts_near_zero(table.read_leniently(column))
        kind = (
            "frame"
            if score <= 0 and not moments and _counts(table.read_leniently(column))
            else kind
        )
        found.append(
            (score + moments + near - 2.0 * (kind == "frame") - 0.01 * place, column, kind)
        )
    return tuple((column, kind) for _, column, kind in sorted(found, key=lambda f: -f[0]))


def _is_running(values: np.ndarray) -> bool:
    """Whether values mostly rise, and are not constant."""
    seen = values[np.isfinite(values)]
    if seen.size < 2 or seen.size < 0.5 * values.size or np.ptp(seen) == 0:
        return False
    return bool((np.diff(seen) >= 0).mean() > 0.9)


def _starts_near_zero(values: np.ndarray) -> float:
    seen = values[np.isfinite(values)]
    return 0.5 if abs(seen[0]) <= 0.1 * np.ptp(seen) else 0.0


def _counts(values: np.ndarray) -> bool:
    seen = values[np.isfinite(values)]
    return bool((np.diff(seen) == 1).mean() > 0.9)
