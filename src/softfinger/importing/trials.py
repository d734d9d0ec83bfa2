"""Which rows of which tables are one trial."""

import itertools
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
import pandas as pd

from softfinger.importing.clock import list_clocks, read_times
from softfinger.importing.description import ImportDescription
from softfinger.importing.faults import ImportFault
from softfinger.importing.side_by_side import split_columns, split_groups
from softfinger.importing.table import RawTable
from softfinger.importing.topics import group_topics, name_topics

LEAST_ROWS = 4
SEPARATOR = ": "  # between a topic and its column


@dataclass(frozen=True, eq=False)
class Run:
    """One trial: its tables by topic."""

    name: str
    tables: dict[str, RawTable]

    @property
    def columns(self) -> list[str]:
        """Columns of all tables, with topics where several."""
        if len(self.tables) == 1:
            return next(iter(self.tables.values())).columns
        return [f"{k}{SEPARATOR}{c}" for k, table in self.tables.items() for c in table.columns]

    def find(self, column: str) -> tuple[RawTable, str]:
        """Find a column's table and its name there.

        Raises
        ------
        ImportFault
            There is no such column, or several.
        """
        topic, mark, name = column.partition(SEPARATOR)
        if mark and topic in self.tables and name in self.tables[topic].cells:
            return self.tables[topic], name
        found = [table for table in self.tables.values() if column in table.cells]
        if len(found) == 1:
            return found[0], column
        raise ImportFault(
            f"trial {self.name}: there is {'no' if not found else 'more than one'} column "
            f"'{column}'; there are {', '.join(self.columns)}"
        )

    @property
    def stated(self) -> dict:
        """What is stated above its tables."""
        return {k: v for table in self.tables.values() for k, v in table.stated.items()}


def split_trials(
    tables: Sequence[RawTable], description: ImportDescription, name: str
) -> list[Run]:
    """Cut tables into trials as described.

    Raises
    ------
    ImportFault
        The column that names the trials is missing.
    """
    by, column = description.trials.by, description.trials.column
    if by in ("file", "folder", "all", "clock"):
        tables = stack_blocks(tables)
    if by == "all":
        runs = [Run(name, name_topics(tables))]
    elif by == "folder":
        runs = [Run(key, name_topics(group)) for key, group in group_topics(tables).items()]
    elif by == "column":
        if column is None:
            raise ImportFault("trials: {by: column} needs the column: type trials: {column: …} too")
        runs = [run for table in tables for run in _split_by_column(table, column, len(tables) > 1)]
    elif by == "clock":
        runs = [run for table in tables for run in _split_by_clock(table, description)]
    elif by == "columns":
        runs = _split_sideways(tables, split_columns)
    elif by == "group":
        runs = _split_sideways(tables, split_groups)
    else:
        runs = [
            Run(key, {"": table}) for key, table in zip(name_tables(tables), tables, strict=True)
        ]
    kept = [run for run in _number_repeats(runs) if run.name not in description.trials.leave_out]
    if not kept:
        raise ImportFault(f"{name}: no trial is left; see trials.leave_out")
    return kept


def stack_blocks(tables: Sequence[RawTable]) -> list[RawTable]:
    """Put the blocks of a file under one another."""
    joined: list[RawTable] = []
    for table in tables:
        last = joined[-1] if joined else None
        if last is None or (last.file, last.sheet, last.columns) != (
            table.file,
            table.sheet,
            table.columns,
        ):
            joined.append(table)
            continue
        cells = pd.concat([last.cells, table.cells], ignore_index=True)
        stated = {key: value for key, value in last.stated.items() if key != "title"}
        joined[-1] = replace(last, cells=cells, row=np.r_[last.row, table.row], stated=stated)
    return joined


def name_tables(tables: Sequence[RawTable]) -> list[str]:
    """Name each table by what distinguishes it."""
    stems = [str(table.file.with_suffix("")) for table in tables]
    short = [table.file.stem for table in tables]
    stems = short if len(set(short)) == len(set(stems)) else [s.replace("/", "_") for s in stems]
    several = len(set(stems)) > 1
    names = []
    for stem, table in zip(stems, tables, strict=True):
        parts = [stem] if several or not table.sheet else []
        names.append(" ".join([*parts, *filter(None, [table.sheet])]))
    titles = [str(table.stated.get("title", ("", ""))[0]) for table in tables]
    if len(set(names)) < len(names):
        names = [title or name for name, title in zip(names, titles, strict=True)]
    return names


def _number_repeats(runs: list[Run]) -> list[Run]:
    counts: dict[str, int] = {}
    for run in runs:
        counts[run.name] = counts.get(run.name, 0) + 1
    seen: dict[str, int] = {}
    numbered = []
    for run in runs:
        seen[run.name] = seen.get(run.name, 0) + 1
        repeated = counts[run.name] > 1
        numbered.append(replace(run, name=f"{run.name} {seen[run.name]}") if repeated else run)
    return numbered


def _split_by_column(table: RawTable, column: str, several: bool) -> list[Run]:
    if column not in table.cells:
        said = f"{table.place}: there is no column '{column}'; it has {', '.join(table.columns)}"
        raise ImportFault(said)
    labels = table.cells[column].astype(str).str.strip().str.removesuffix(".0")
    runs = []
    for label in labels[labels != ""].unique():
        rows = np.flatnonzero((labels == label).to_numpy())
        number = label.replace(".", "").lstrip("-").isdigit()
        name = f"{column} {label}" if number else label
        name = f"{table.file.stem} {name}" if several else name
        runs.append(Run(name, {"": table.take(rows)}))
    return runs


def find_restarts(seconds: np.ndarray) -> np.ndarray:
    """Rows at which a clock starts anew.

    >>> find_restarts(np.array([0.0, 1, 2, 3, 0, 1, 2, 1.9, 3]))
    array([4])
    """
    seen = np.flatnonzero(np.isfinite(seconds))
    known, restarts, begin = seconds[seen], [], 0
    for row in np.flatnonzero(np.diff(known) < 0) + 1:
        span = known[row - 1] - known[begin]
        if known[row - 1] - known[row] > 0.5 * span > 0:
            restarts.append(int(seen[row]))
            begin = row
    return np.array(restarts, dtype=int)


def _split_by_clock(table: RawTable, description: ImportDescription) -> list[Run]:
    column = description.clock.column or _find_clock(table)
    seconds = read_times(table, column, description.clock.unit).seconds
    edges = [0, *find_restarts(seconds), len(seconds)]
    stem = table.sheet or table.file.stem
    pieces = [np.arange(a, b) for a, b in itertools.pairwise(edges)]
    return [
        Run(f"{stem} {k + 1}" if len(pieces) > 1 else stem, {"": table.take(rows)})
        for k, rows in enumerate(pieces)
    ]


def _find_clock(table: RawTable) -> str:
    clocks = list_clocks(table)
    if not clocks:
        raise ImportFault(
            f"{table.place}: no column is a clock that starts anew with each trial; type clock: "
            "{column: …}, or trials: {by: file} where each file is one trial"
        )
    return clocks[0][0]


def _split_sideways(
    tables: Sequence[RawTable], split: Callable[[RawTable], list[tuple[str, RawTable]]]
) -> list[Run]:
    several = len(tables) > 1
    return [
        Run(f"{table.sheet or table.file.stem} {name}" if several else name, {"": part})
        for table in tables
        for name, part in split(table)
    ]
