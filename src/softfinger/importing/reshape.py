"""Long tables made wide: a row per time."""

import re
from dataclasses import replace

import numpy as np
import pandas as pd

from softfinger.faults import Fault
from softfinger.importing.clock import read_times
from softfinger.importing.headings import split_heading
from softfinger.importing.table import RawTable
from softfinger.importing.vocabulary import CLOCK, JOINT, POINT, SIGNAL, TRIAL, VALUE, pick

ARRAY = re.compile(r"[\[(]\s*([-+0-9.eE]+(?:\s*,\s*[-+0-9.eE]+)*)\s*,?\s*[\])]")
CORNER = re.compile(r"(?:corner|c|p|pt)?[ _]?(?:([xy])[ _]?\d|\d[ _]?([xy]))")
GLIMPSE = 8  # rows that are looked at first, for there may be millions
MOST_POINTS, MOST_SIGNALS, MOST_JOINTS = 200, 60, 20


def widen(table: RawTable) -> RawTable:
    """Give every point or signal its own columns.

    A table of points has an id and coordinates, and several ids at one time; a table of signals
    has a name and a value; one of joints has a joint in each row. Any other table stays as it is,
    but for stamps in two columns (seconds and nanoseconds), which become one, and for rows that run
    backwards in time, which are turned round.
    """
    table = _turn_round(_join_stamps(_spread_arrays(table)))
    for widened in (_widen_points(table), _widen_signals(table), _widen_joints(table)):
        if widened is not None:
            return widened
    return table


def _spread_arrays(table: RawTable) -> RawTable:
    """Give each number of an array its own column.

    The array is in one cell, as ``(0.1, 0.2)``.
    """
    for column in table.columns:
        if not any(ARRAY.fullmatch(str(cell).strip()) for cell in table.cells[column].head(3)):
            continue
        found = [ARRAY.fullmatch(str(cell).strip()) for cell in table.cells[column]]
        rows = [[part.strip() for part in match[1].split(",")] if match else [] for match in found]
        width = max(map(len, rows), default=0)
        if width < 2 or sum(len(row) == width for row in rows) < 0.9 * len(rows):
            continue
        rows = [row if len(row) == width else [""] * width for row in rows]
        names = [f"{column} {k + 1}" for k in range(width)]
        parts = pd.DataFrame(rows, columns=names, index=table.cells.index, dtype=object)
        cells = pd.concat([table.cells.drop(columns=[column]), parts], axis=1)
        unit = {n: table.unit[column] for n in names if column in table.unit}
        table = replace(table, cells=cells, unit=table.unit | unit)
    return table


def _join_stamps(table: RawTable) -> RawTable:
    """One column of seconds out of ROS's two."""
    ends = re.compile(r"(.*?)(secs?|seconds?)$", re.IGNORECASE)
    for column in table.columns:
        found = ends.match(column)
        same = re.escape(found[1] if found else column)
        finer = re.compile(same + r"(nsecs?|nanosecs?|nanoseconds?)", re.IGNORECASE)
        fine = [c for c in table.columns if finer.fullmatch(c)]
        if found and fine:
            whole = table.read_leniently(column) + 1e-9 * table.read_leniently(fine[0])
            cells = table.cells.drop(columns=[column, fine[0]])
            cells.insert(0, f"{found[1]}stamp", whole)
            return replace(table, cells=cells)
    return table


def _turn_round(table: RawTable) -> RawTable:
    """Put the newest row last."""
    count = len(table.row)
    ends = table.take(np.unique(np.linspace(0, count - 1, min(count, GLIMPSE)).astype(int)))
    for column in pick(table.columns, CLOCK["time"]):
        if _falls(ends, column) and _falls(table, column):
            said = f"column '{column}' runs backwards: the rows are read from the last to the first"
            turned = table.take(np.arange(count)[::-1])
            return replace(
                turned,
                cells=turned.cells.reset_index(drop=True),
                dropped=(*table.dropped, said),
            )
    return table


def _falls(table: RawTable, column: str) -> bool:
    """Whether times fall from row to row."""
    try:
        seconds = read_times(table, column).seconds
    except Fault:
        return False
    steps = np.diff(seconds[np.isfinite(seconds)])
    return bool(steps.size and (steps <= 0.0).all() and (steps < 0.0).any())


def _find_moment(table: RawTable) -> str | None:
    for words in CLOCK.values():
        found = pick(table.columns, words)
        if found:
            return found[0]
    return None


def _widen_points(table: RawTable) -> RawTable | None:
    moment = _find_moment(table)
    table = _reduce_corners(table)
    places = [c for c in table.columns if c.strip().lower()[-1:] in "xyz"]
    ids = [c for c in pick(table.columns, POINT) if c not in places and c != moment]
    if moment is None or len(places) < 2:
        return None
    for column in ids:
        key = table.cells[column].map(_to_label)
        several = table.cells.groupby(moment, sort=False)[column].nunique().median() > 1
        if several and 2 <= key.nunique() <= MOST_POINTS:
            return _pivot(table, moment, key)
    return None


def _reduce_corners(table: RawTable) -> RawTable:
    """Replace four corners by their centre."""
    corners: dict[str, list[str]] = {"x": [], "y": []}
    for column in table.columns:
        if found := CORNER.fullmatch(column.strip().lower()):
            corners[found[1] or found[2]].append(column)
    if not len(corners["x"]) == len(corners["y"]) == 4:
        return table
    cells = table.cells.drop(columns=corners["x"] + corners["y"])
    if not any(column.strip().lower()[-1:] in "xy" for column in cells):
        for axis, columns in corners.items():
            cells[axis] = np.mean([table.read_leniently(column) for column in columns], axis=0)
    return replace(table, cells=cells)


def _widen_signals(table: RawTable) -> RawTable | None:
    moment = _find_moment(table)
    values = pick(table.columns, VALUE)
    names = [c for c in pick(table.columns, SIGNAL) if c not in values]
    if moment is None or not values or not names:
        return None
    key = table.cells[names[0]].map(_to_label)
    if not 2 <= key.nunique() <= MOST_SIGNALS:
        return None
    units = pick(table.columns, "unit units einheit")
    wide = _pivot(replace(table, cells=table.cells[[moment, values[0]]]), moment, key)
    columns = {c: c.removesuffix(f" {values[0]}") for c in wide.columns}
    unit = {c: u for c, u in wide.unit.items() if c in wide.columns}
    if units:
        unit |= {name: str(table.cells.loc[key == name, units[0]].iloc[0]) for name in key.unique()}
    else:  # a label may bear its unit, as a heading does
        split = {label: split_heading(label) for label in key.unique()}
        unit |= {name: own for name, own in split.values() if own}
        columns = {c: split[label][0] if label in split else label for c, label in columns.items()}
        columns |= {c: c for c, label in columns.items() if list(columns.values()).count(label) > 1}
    cells = wide.cells.rename(columns=columns)
    return replace(wide, cells=cells, unit={columns.get(c, c): u for c, u in unit.items()})


def _widen_joints(table: RawTable) -> RawTable | None:
    """Give every joint its own columns.

    What all joints share has one.
    """
    moment = _find_moment(table)
    joints = pick(table.columns, JOINT)
    if moment is None or not joints:
        return None
    joint = joints[0]
    runs = [c for c in pick(table.columns, TRIAL) if c not in (moment, joint)]
    key = table.cells[joint].map(_to_label)
    index = [*runs, moment]
    labels = _sort_labels(key.unique().tolist())
    cells = table.cells.assign(**{joint: key})
    if not 2 <= len(labels) <= MOST_JOINTS or cells.duplicated([*index, joint]).any():
        return None
    rows = cells.groupby(index, sort=False, dropna=False)
    if rows.size().median() < 2:
        return None
    first = ~cells.duplicated(index)
    wide, unit = cells.loc[first, index].reset_index(drop=True), {}
    for column in [c for c in cells if c not in (*index, joint)]:
        if rows[column].nunique().max() <= 1:
            wide[column] = cells.loc[first, column].to_numpy(dtype=object)
            unit |= {column: table.unit[column]} if column in table.unit else {}
            continue
        spread = cells.set_index([*index, joint])[column].unstack(joint)
        spread = spread.reindex(pd.MultiIndex.from_frame(wide[index]) if runs else wide[moment])
        for label in labels:
            name = f"{column} {label}"
            wide[name] = spread[label].fillna("").to_numpy(dtype=object)
            unit |= {name: table.unit[column]} if column in table.unit else {}
    unit |= {c: table.unit[c] for c in index if c in table.unit}
    row = table.row[first.to_numpy()]
    return replace(table, cells=wide, row=row, unit=unit, group={})


def _pivot(table: RawTable, moment: str, key: pd.Series) -> RawTable:
    """One row per time, columns by key and name."""
    cells = table.cells
    first = pd.factorize(cells[moment])[0]
    count = int(first.max()) + 1
    others = [c for c in cells.columns if c != moment and not cells[c].map(_to_label).equals(key)]
    row = np.full(count, np.iinfo(np.int64).max)
    np.minimum.at(row, first, table.row)
    begin = np.full(count, len(cells))
    np.minimum.at(begin, first, np.arange(len(cells)))
    columns = {moment: cells[moment].to_numpy(dtype=object)[begin]}
    unit = {moment: table.unit[moment]} if moment in table.unit else {}
    for label in _sort_labels(key.unique().tolist()):
        at = np.flatnonzero((key == label).to_numpy())
        for column in others:
            name = f"{label} {column}"
            columns[name] = np.full(count, "", dtype=object)
            columns[name][first[at]] = cells[column].to_numpy(dtype=object)[at]
            if column in table.unit:
                unit[name] = table.unit[column]
    wide = pd.DataFrame(columns)
    order = np.argsort(row, kind="stable")
    return replace(
        table, cells=wide.iloc[order].reset_index(drop=True), row=row[order], unit=unit, group={}
    )


def _sort_labels(labels: list[str]) -> list[str]:
    numbers = all(label.lstrip("-").isdigit() for label in labels)
    return sorted(labels, key=int) if numbers else labels


def _to_label(cell: object) -> str:
    """Name of an id, as text.

    A whole number has no point.

    >>> _to_label(3.0), _to_label("12.0"), _to_label("tip")
    ('3', '12', 'tip')
    """
    text = str(cell).strip()
    return text[:-2] if text.endswith(".0") and text[:-2].lstrip("-").isdigit() else text
