"""A date and a time of day in columns of their own."""

import datetime as dt
from collections.abc import Callable
from dataclasses import replace

from softfinger.importing.cells import MOMENT
from softfinger.importing.table import RawTable

PROBED = 20  # rows that show what a column contains


def join_date(table: RawTable) -> RawTable:
    """Write a column's dates before another's times of day.

    The table stays as it is where it has not one column of each.
    """
    dates = [c for c in table.columns if _contains(table, c, _is_date)]
    times = [c for c in table.columns if _contains(table, c, _is_time)]
    if len(dates) != 1 or len(times) != 1:
        return table
    (date,), (time,) = dates, times
    pairs = zip(table.cells[date], table.cells[time], strict=True)
    joined = [_join(*pair) for pair in pairs]
    cells = table.cells.assign(**{time: joined}).drop(columns=date)
    return replace(table, cells=cells, dropped=(*table.dropped, f"'{date}' is part of '{time}'"))


def _contains(table: RawTable, column: str, kind: Callable[[object], bool]) -> bool:
    cells = [cell for cell in table.cells[column].head(PROBED) if str(cell).strip()]
    return bool(cells) and all(map(kind, cells))


def _is_date(cell: object) -> bool:
    if isinstance(cell, dt.datetime):
        return cell.time() == dt.time()
    if isinstance(cell, dt.date):
        return True
    return isinstance(cell, str) and bool(MOMENT.fullmatch(cell.strip())) and ":" not in cell


def _is_time(cell: object) -> bool:
    if isinstance(cell, dt.time):
        return True
    if not isinstance(cell, str) or not MOMENT.fullmatch(cell.strip()):
        return False
    return cell.count(":") == 2 and not any(mark in cell.split(":")[0] for mark in "-/.")


def _join(date: object, time: object) -> object:
    if isinstance(time, str):
        day = date.strftime("%Y-%m-%d") if isinstance(date, dt.date) else str(date).strip()
        return f"{day} {time.strip()}" if time.strip() else ""
    if isinstance(time, dt.time) and isinstance(date, dt.datetime):
        return dt.datetime.combine(date.date(), time)
    return f"{date} {time}"
