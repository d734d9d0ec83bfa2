"""Which tables and rows belong to one trial."""

from __future__ import annotations

import itertools
from collections import Counter
from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from softfinger.campaign.units import find_factor
from softfinger.faults import Fault
from softfinger.importing.clock import list_clocks, read_times
from softfinger.importing.faults import ImportFault
from softfinger.importing.points import NAMELESS, find_points, list_point_columns
from softfinger.importing.side_by_side import (
    list_groups,
    list_single_columns,
    split_trial_names,
)
from softfinger.importing.table import RawTable
from softfinger.importing.topics import find_role, group_topics
from softfinger.importing.trials import find_restarts
from softfinger.importing.vocabulary import CLOCK, LOAD, MOTION, TRIAL, find_quantity, pick

if TYPE_CHECKING:
    from softfinger.importing.guess import Guesses

LEAST_ROWS = 4  # of a trial
TIMED = 0.9  # of the rows have a time, where a clock cuts trials


def guess_trials(tables: Sequence[RawTable], guesses: Guesses) -> tuple[list[RawTable], list[str]]:
    """Choose the tables, and how trials are cut.

    Returns
    -------
    tables, dropped
        The tables, in common units; sentences on those that are left out.
    """
    if guesses.get("trials.by") is None:
        kind = _find_topics(tables)
        if kind is not None:
            what = "recording" if kind == "all" else "folder or name"
            guesses.put("trials.by", kind, f"each file is a topic of one {what}")
    if guesses.get("trials.by") in ("all", "folder"):
        return list(tables), []
    tables, dropped = _choose_tables(tables)
    tables, said = unify_units(tables)
    guesses.said += said
    if guesses.get("trials.by") is None:
        by, column, why = _find_cut(tables[0], tables)
        guesses.put("trials.by", by, why)
        if column:
            guesses.put("trials.column", column, why)
    return tables, dropped


def _find_topics(tables: Sequence[RawTable]) -> str | None:
    """Whether files are topics of one recording.

    It is ``all`` where all files are of one, ``folder`` where those of a folder (or name) are,
    and None where they are not.
    """
    if len(tables) < 2:
        return None
    whole = [_has_both(table) for table in tables]
    if any(whole):
        return None
    groups = group_topics(tables)
    if all(_are_topics(group) for group in groups.values()):
        return "folder" if len(groups) > 1 else "all"
    return "all" if _are_topics(tables) else None


def _are_topics(tables: Sequence[RawTable]) -> bool:
    """Whether tables are topics of one recording."""
    if len(tables) < 2:
        return False
    roles = {_find_table_role(table) for table in tables}
    return {"motion", "load"} <= roles and _overlap(tables)


def _find_table_role(table: RawTable) -> str | None:
    motion = _has(table, MOTION) or len(find_points(table.columns)) > 0
    load = _has(table, LOAD)
    if motion != load:
        return "motion" if motion else "load"
    return find_role(f"{table.file.stem} {table.sheet}") or find_role(table.file.parent.name)


def _has(table: RawTable, role: dict[str, str]) -> bool:
    columns = set(table.columns) - list_point_columns(table.columns)  # p1 x is no pressure
    return any(find_quantity(c, table.unit.get(c, ""), role)[1] >= 1.5 for c in columns)


def _has_both(table: RawTable) -> bool:
    points = len(find_points(table.columns)) > 0
    return (points or _has(table, MOTION)) and _has(table, LOAD)


def _overlap(tables: Sequence[RawTable]) -> bool:
    """Whether clocks run at once.

    Of clocks with nothing in common: whether they run as long.
    """
    spans, dated = [], set()
    for table in tables:
        clocks = [column for column, kind in list_clocks(table) if kind == "time"]
        if not clocks:  # it counts frames, and its rate is declared
            continue
        times = read_times(table, clocks[0])
        spans.append((np.nanmin(times.seconds), np.nanmax(times.seconds)))
        dated.add(times.zero is not None)
    begin, end = np.array(spans).T
    shortest = (end - begin).min()
    if len(dated) > 1:
        return bool(shortest > 0.5 * (end - begin).max())
    return bool(end.min() - begin.max() > 0.5 * shortest)


def _choose_tables(tables: Sequence[RawTable]) -> tuple[list[RawTable], list[str]]:
    """Tables of the usual columns; names of others."""
    weights: Counter[tuple[str, ...]] = Counter()
    for table in tables:
        movable = _has(table, MOTION) or len(find_points(table.columns)) > 0
        clocked = bool(list_clocks(table))
        short = len(table.row) < LEAST_ROWS
        weights[_sign(table)] += (
            0 if short else len(table.row) * (1 + 100 * movable + 100 * clocked)
        )
    best = weights.most_common(1)[0][0]
    names = set(best)
    kept, dropped = [], []
    for table in tables:
        own = set(_sign(table))
        if (own == names or len(own & names) >= 0.8 * len(names)) and len(table.row) >= LEAST_ROWS:
            kept.append(table)
        else:
            why = "it has other columns" if own != names else f"it has {len(table.row)} rows"
            dropped.append(f"{table.place}: {why}")
    if not kept:
        raise ImportFault(f"no table has {LEAST_ROWS} rows or more; expected a recording over time")
    return kept, dropped


def _sign(table: RawTable) -> tuple[str, ...]:
    return tuple(sorted(column.strip().lower() for column in table.columns))


def unify_units(tables: Sequence[RawTable]) -> tuple[list[RawTable], list[str]]:
    """Give columns the unit of their first table."""
    wanted: dict[str, str] = {}
    for table in tables:
        for column, unit in table.unit.items():
            wanted.setdefault(column, unit)
    unified, said = [], []
    for table in tables:
        cells, unit = table.cells, dict(table.unit)
        for column in [c for c, u in unit.items() if u != wanted[c] and c in cells]:
            factor = find_factor(unit[column], wanted[column])
            cells = cells.assign(**{column: table.read(column) * factor})
            said.append(
                f"{table.place}, column '{column}': {unit[column]} turned into {wanted[column]}"
            )
            unit[column] = wanted[column]
        unified.append(replace(table, cells=cells, unit=unit))
    return unified, said


def _find_cut(table: RawTable, tables: Sequence[RawTable]) -> tuple[str, str | None, str]:
    """How trials are cut, its column, and why."""
    groups = list_groups(table)
    repeat = "group", None, f"the same columns repeat for {', '.join(list(groups)[:4])}"
    if groups and groups == split_trial_names(table):
        return repeat
    column = _find_trial_column(table)
    if column:
        return "column", column, f"'{column}' names runs of rows"
    if _is_grouped(table):
        return repeat
    single = list_single_columns(table)
    if single and not (_has(table, MOTION) or _has(table, LOAD) or find_points(table.columns)):
        return "columns", None, f"{', '.join(single[:4])} are alike"
    if _restarts(table):
        return "clock", None, "the clock starts again"
    by = "file"
    if len({t.sheet for t in tables}) > 1:
        by = "sheet"
    if len({(t.file, t.sheet) for t in tables}) < len(tables):
        by = "block"
        going = _find_going(tables)
        if going:
            return going, None, "the clock goes on from block to block"
    words = {"file": "each file", "sheet": "each sheet", "block": "each block under a heading"}
    return (
        by,
        None,
        f"{words[by]} has the same columns" if len(tables) > 1 else "there is one table",
    )


def _find_going(tables: Sequence[RawTable]) -> str | None:
    """How blocks are cut whose clock goes on; else None."""
    files: dict[tuple[str, str], list[RawTable]] = {}
    for table in tables:
        files.setdefault((str(table.file), table.sheet), []).append(table)
    steps, spans = [], []
    for blocks in files.values():
        clocks = [column for column, kind in list_clocks(blocks[0]) if kind == "time"]
        if not clocks:
            return None
        seconds = [
            read_times(table, clocks[0]).seconds for table in blocks if clocks[0] in table.cells
        ]
        pairs = itertools.pairwise(seconds)
        steps += [float(np.nanmin(later) - np.nanmax(sooner)) for sooner, later in pairs]
        spans += [float(np.nanmax(times) - np.nanmin(times)) for times in seconds]
    if not steps or np.mean(np.array(steps) > 0.0) < 0.5 or np.median(steps) > np.median(spans):
        return None  # what waits longer than it lasts is recorded again
    return "file" if min(steps) > 0.0 else "clock"


def _find_trial_column(table: RawTable) -> str | None:
    clocks = [column for column, _ in list_clocks(table)]
    for column in pick(table.columns, TRIAL):
        if column in clocks or column in table.group:  # what is above it names it
            continue
        labels = table.cells[column].astype(str).to_numpy()
        runs = int((labels[1:] != labels[:-1]).sum()) + 1
        distinct = len(set(labels))
        if 1 < distinct <= len(labels) / LEAST_ROWS and runs == distinct:
            return column
        if 1 < distinct <= len(labels) / LEAST_ROWS and _rise_within(table, labels, clocks):
            return column
    return None


def _rise_within(table: RawTable, labels: np.ndarray, clocks: list[str]) -> bool:
    """Whether labels separate runs of the clock."""
    times = [c for c in table.columns if c in clocks] or pick(table.columns, "time t zeit frame")
    if not times:
        return False
    seconds = table.read_leniently(times[0])
    within = all((np.diff(seconds[labels == label]) >= 0).all() for label in set(labels))
    return within and bool((np.diff(seconds) < 0).any())


def _is_grouped(table: RawTable) -> bool:
    """Whether columns are trials side by side."""
    groups = list_groups(table)
    if len(groups) < 2:
        return False
    own = list(next(iter(groups.values())))
    if any(pick([name], " ".join(CLOCK.values())) for name in own):
        return True
    points = find_points(own)
    if points:  # without a name of their own they are points of one trial
        return any(point.name != NAMELESS for point in points)
    units = {c: table.unit.get(c, "") for members in groups.values() for c in members.values()}
    motions = [find_quantity(n, units.get(next(iter(groups.values()))[n], ""), MOTION) for n in own]
    shared = len(table.columns) - sum(len(members) for members in groups.values())
    loads = [find_quantity(n, "", LOAD)[1] >= 1.5 for n in own]
    moved = [quantity for quantity, score in motions if score >= 1.5 and quantity != "angle"]
    return bool(moved) and shared <= 2 and len(own) <= 3 and (len(own) == 1 or any(loads))


def _restarts(table: RawTable) -> bool:
    """Whether the clock starts long pieces anew."""
    for column in [*pick(table.columns, "time t zeit timestamp elapsed frame"), *table.columns[:1]]:
        try:
            seconds = read_times(table, column).seconds
        except Fault:
            continue
        if np.isfinite(seconds).mean() < TIMED:
            continue
        edges = [0, *find_restarts(seconds), len(seconds)]
        if len(edges) > 2:
            falls = np.diff(seconds[np.isfinite(seconds)]) < 0
            return bool(np.diff(edges).min() >= LEAST_ROWS and falls.mean() < 0.2)
    return False
