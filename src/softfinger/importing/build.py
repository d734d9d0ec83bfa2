"""Trials in the campaign's form."""

import datetime as dt
from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
import pandas as pd

from softfinger.campaign.units import find_factor
from softfinger.importing.cells import read_numbers
from softfinger.importing.clock import list_clocks, read_times
from softfinger.importing.description import ImportDescription
from softfinger.importing.faults import ImportFault
from softfinger.importing.motion import find_last, read_motion
from softfinger.importing.table import RawTable
from softfinger.importing.trials import LEAST_ROWS, Run

MOST_REPEATED = 0.3  # of the rows have the time of the row before
NO_CLOCK = (
    "no column is a clock, and the frame rate is not stated; type clock: {frames_per_second: 30} "
    "in import.yaml or --fps 30, with your camera's rate"
)


@dataclass(frozen=True, eq=False)
class ImportedTrial:
    """One trial, ready to be written.

    Attributes
    ----------
    time : (frame,) [s]
    motion : (frame, column)
        In the declared unit, angles in rad; of markers (frame, 2 · point) [px].
    load_time : (row,) [s]; load : (row,)
        Empty where no load is known.
    points
        Names of the points, where `motion` is their places.
    row : (frame,)
        Numbers of the rows in the file.
    """

    name: str
    time: np.ndarray
    motion: np.ndarray
    load_time: np.ndarray
    load: np.ndarray
    points: tuple[str, ...] = ()
    started_at: dt.datetime | None = None
    covariates: Mapping[str, float] = field(default_factory=dict)
    row: np.ndarray = field(default_factory=lambda: np.zeros(0, int))
    notes: tuple[str, ...] = ()


def build_trial(run: Run, description: ImportDescription) -> ImportedTrial:
    """Read one trial's motion and load.

    Raises
    ------
    ImportFault
        A column is missing, a cell is no number, times run backwards, too few rows are left.
    """
    table, motion, points = read_motion(run, description)
    time, zero, gone = _read_clock(run, table, description)
    seen = np.isfinite(time) & (np.arange(len(time)) <= find_last(motion))
    _check_times(run, table, time)
    counted = description.clock.start in ("first row", "each first row")
    origin = float(np.nanmin(time)) if counted else 0.0
    load_time, load = _read_load(run, description, origin, float(np.nanmin(time)))
    if seen.sum() < LEAST_ROWS or np.isfinite(motion[seen]).any(axis=1).sum() < LEAST_ROWS:
        raise ImportFault(
            f"trial {run.name}: {int(seen.sum())} rows have a time and a motion; expected at least "
            f"{LEAST_ROWS}; name it in trials.leave_out to go without it"
        )
    started = None
    if zero is not None:
        started = zero + dt.timedelta(seconds=float(np.nanmin(time)))
    notes = [f"{gone} rows without a time"] if gone else []
    after = len(time) - 1 - find_last(motion)
    notes += [f"{after} rows after the last motion"] if after else []
    return ImportedTrial(
        run.name, time[seen] - origin, motion[seen], load_time, load, points, started,
        _read_covariates(run, description), table.row[seen], tuple(notes),
    )  # fmt: skip


def _read_clock(
    run: Run, table: RawTable, description: ImportDescription
) -> tuple[np.ndarray, dt.datetime | None, int]:
    """Read the clock of a run's table.

    The function returns times (row,) [s], the moment of time 0, and rows without a time.
    """
    asked = description.clock
    rate = asked.frames_per_second or (1.0 / asked.interval_s if asked.interval_s else None)
    column = None
    if asked.column is not None:
        name = asked.column.rpartition(": ")[2]
        column = name if name in table.cells else None
        if column is None and len(run.tables) == 1:
            run.find(asked.column)
    timed = []
    if column is None or rate is not None:
        timed = [c for c, kind in list_clocks(table) if kind == "time"]
    if column is None and (rate is None or len(run.tables) > 1):
        column = timed[0] if timed else None
    if column is None:
        if rate is None:
            raise ImportFault(f"{table.place}: {NO_CLOCK}")
        return np.arange(len(table.row)) / rate, None, 0
    if rate is not None and not (column in timed and len(run.tables) > 1):
        time = table.read(column, what="the number of a frame") / rate
        return time, None, int((~np.isfinite(time)).sum())
    times = read_times(table, column, asked.unit)
    return times.seconds, times.zero, int((~np.isfinite(times.seconds)).sum())


def _check_times(run: Run, table: RawTable, time: np.ndarray) -> None:
    seen = np.flatnonzero(np.isfinite(time))
    if not seen.size:
        raise ImportFault(f"trial {run.name}: no row has a time")
    backwards = np.flatnonzero(np.diff(time[seen]) < 0)
    if backwards.size:
        at = seen[backwards[0] + 1]
        raise ImportFault(
            f"{table.place}, row {table.row[at]}: time runs backwards in trial {run.name}; are "
            "there several trials in it? Type trials: {by: clock}, or sort the rows"
        )
    same = np.diff(time[seen]) == 0
    if same.sum() > MOST_REPEATED * len(seen):
        at, each = table.row[seen[np.argmax(same) + 1]], len(seen) / (len(seen) - same.sum())
        step = np.median(np.diff(np.unique(time[seen]))) / each
        raise ImportFault(
            f"{table.place}, row {at}: trial {run.name} has {each:.2g} rows at each time. Is the "
            f"clock too coarse? Then type clock: {{interval_s: {step:.3g}}}, without its column. "
            "Are there several signals in it? Then give each a column of its own"
        )


def _read_load(
    run: Run, description: ImportDescription, origin: float, first: float
) -> tuple[np.ndarray, np.ndarray]:
    """Times [s] and values of the load log."""
    asked, sign = description.load, description.load.sign or 1
    if asked.none:
        return np.zeros(0), np.zeros(0)
    if asked.column is not None:
        table, name = run.find(asked.column)
        value = table.read(name, asked.unit or "") * sign
        time = _read_clock(run, table, description)[0]
        seen = np.isfinite(value) & np.isfinite(time)
        if not seen.any():
            raise ImportFault(f"{table.place}, column '{name}': it contains no load")
        if description.clock.start == "each first row":
            origin = float(np.nanmin(time))
        order = np.argsort(time[seen], kind="stable")
        time, value = time[seen][order] - origin, value[seen][order]
        return hold_load(time, value) if asked.between == "held" else (time, value)
    if asked.value is not None:
        value = asked.value
    elif asked.stated is not None:
        value = read_stated(run, asked.stated, asked.unit or "")
    else:
        raise ImportFault("load: name its column, a key that is stated, a value, or none: true")
    begin = asked.from_s if asked.from_s is not None else first - origin
    return np.array([begin]), np.array([sign * value])


def hold_load(time: np.ndarray, value: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Let each row's load stay until the next row.

    >>> hold_load(np.array([0.0, 2.0, 8.0]), np.array([0.0, 20.0, 20.0]))
    (array([0., 2., 2., 8.]), array([ 0.,  0., 20., 20.]))
    """
    changed = np.flatnonzero(np.diff(value)) + 1
    order = np.argsort(np.r_[2 * np.arange(len(time)), 2 * changed - 1], kind="stable")
    return np.r_[time, time[changed]][order], np.r_[value, value[changed - 1]][order]


def read_stated(run: Run, key: str, unit: str = "") -> float:
    """Number stated above a trial's table, in a unit.

    Raises
    ------
    ImportFault
        It is not stated there, or is no number.
    """
    if key not in run.stated:
        listed = ", ".join(run.stated) or "nothing"
        raise ImportFault(f"trial {run.name}: '{key}' is not stated; stated are {listed}")
    value, own = run.stated[key]
    decimal = next(iter(run.tables.values())).decimal
    numbers, wrong = read_numbers(pd.Series([value], dtype=object), own, decimal)
    if wrong[0] or not np.isfinite(numbers[0]):
        raise ImportFault(f"trial {run.name}: '{key}' is '{value}'; expected a number")
    return float(numbers[0] * (find_factor(own, unit) if own and unit and own != unit else 1.0))


def _read_covariates(run: Run, description: ImportDescription) -> dict[str, float]:
    values = {}
    for covariate in description.covariates or ():
        if covariate.stated is not None:
            values[covariate.name] = read_stated(run, covariate.stated)
        elif covariate.column is not None:
            table, name = run.find(covariate.column)
            values[covariate.name] = float(np.nanmean(table.read(name)))
    return values
