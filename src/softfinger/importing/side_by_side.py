"""Trials side by side in one table."""

import itertools
import re
from dataclasses import replace

from softfinger.importing.cells import WITH_UNIT
from softfinger.importing.clock import list_clocks
from softfinger.importing.faults import ImportFault
from softfinger.importing.table import RawTable
from softfinger.importing.vocabulary import CLOCK, TRIAL, pick

REPEATED = re.compile(r"(.+) \((\d+)\)")
NUMBERED = re.compile(
    rf"(?<![^\W_])({'|'.join(word for word in TRIAL.split() if word not in ('file', 'finger'))})"
    r"[ _.#-]*(\d+)(?![\d])",
    re.IGNORECASE,
)

"""A trial's number in a heading; several files or fingers may be in one trial."""


def list_groups(table: RawTable) -> dict[str, dict[str, str]]:
    """Groups of columns that are trials.

    The result is group → own name → column.

    Groups are given by an upper heading, else by what names begin or end with. Each must have the
    same names.
    """
    given: dict[str, dict[str, str]] = {}
    for column, group in table.group.items():
        if column in table.cells:
            given.setdefault(group, {})[column.removeprefix(group).strip()] = column
    for groups in (
        given,
        _drop_numbers(given),
        _split_repeats(table),
        split_trial_names(table),
        _split_names(table, 0),
        _split_names(table, -1),
    ):
        sizes = [set(members) for members in groups.values()]
        numbered = bool(sizes) and all(name.strip("()").isdigit() for name in sizes[0])
        if len(sizes) > 1 and all(size == sizes[0] for size in sizes) and not numbered:
            return groups
    return {}


def _drop_numbers(groups: dict[str, dict[str, str]]) -> dict[str, dict[str, str]]:
    """Groups without the numbers that end own names.

    ``Specimen 2`` has ``F2`` and ``d2``.
    """
    return {
        group: {re.sub(r"[ _.-]*\d+$", "", own): column for own, column in members.items()}
        for group, members in groups.items()
    }


def _split_repeats(table: RawTable) -> dict[str, dict[str, str]]:
    """Columns whose names repeat, as ``Force`` and ``Force (2)``.

    A clock that repeats begins a group: what comes before the next one is its, whatever its name.
    """
    found = {column: REPEATED.fullmatch(column) for column in table.columns}
    names = {match[1] for match in found.values() if match}
    groups: dict[str, dict[str, str]] = {}
    for column, match in found.items():
        if match or column in names:
            own, number = (match[1], match[2]) if match else (column, "1")
            groups.setdefault(number, {})[own] = column
    clocks = [name for name in names if pick([name], " ".join(CLOCK.values()))]
    return (_split_at_clock(table, groups, clocks[0]) if clocks else {}) or groups


def _split_at_clock(
    table: RawTable, groups: dict[str, dict[str, str]], clock: str
) -> dict[str, dict[str, str]]:
    """Groups from one clock to the next.

    Their columns are named as the first one's; there are none where their units differ.
    """
    begins = [table.columns.index(own[clock]) for own in groups.values() if clock in own]
    blocks = [table.columns[a:b] for a, b in itertools.pairwise([*begins, len(table.columns)])]
    units = {tuple(table.unit.get(column, "") for column in block) for block in blocks}
    if len(units) != 1 or len(blocks) != len(groups):
        return {}
    own = [clock, *blocks[0][1:]]
    return {
        number: dict(zip(own, b, strict=True)) for number, b in zip(groups, blocks, strict=True)
    }


def split_trial_names(table: RawTable) -> dict[str, dict[str, str]]:
    """Columns by a number after a word for a trial.

    The word is `trial`, `run`, `specimen` or another of `TRIAL`: ``Trial 2 angle``.
    """
    groups: dict[str, dict[str, str]] = {}
    for column in table.columns:
        found = NUMBERED.search(column)
        if found:
            own = f"{column[: found.start()]} {column[found.end() :]}".strip(" _.:-,()") or "value"
            groups.setdefault(" ".join(found.groups()), {})[own] = column
    return groups if len(groups) > 1 else {}


def _split_names(table: RawTable, end: int) -> dict[str, dict[str, str]]:
    """Columns by their first or last part."""
    groups: dict[str, dict[str, str]] = {}
    for column in table.columns:
        parts = re.split(r"[ _.:-]+", column)
        if end == -1 and len(parts) == 1:
            found = re.fullmatch(r"(.*\D)(\d+)", column)
            parts = [found[1], found[2]] if found else parts
        if len(parts) > 1:
            own = " ".join(parts[1:] if end == 0 else parts[:-1])
            groups.setdefault(parts[end].strip("()"), {})[own] = column
    return groups


def split_groups(table: RawTable) -> list[tuple[str, RawTable]]:
    """One table per group, under its name.

    Columns of no group belong to each.

    Raises
    ------
    ImportFault
        Its columns form no groups.
    """
    groups = list_groups(table)
    if not groups:
        said = (
            f"{table.place}: its columns do not form groups of the same names; choose "
            "another trials.by"
        )
        raise ImportFault(said)
    grouped = {column for members in groups.values() for column in members.values()}
    shared = [column for column in table.columns if column not in grouped]
    runs = []
    for group, members in groups.items():
        names = {column: column for column in shared} | {c: own for own, c in members.items()}
        cells = table.cells[list(names)].rename(columns=names)
        unit = {names[c]: u for c, u in table.unit.items() if c in names}
        runs.append((group, replace(table, cells=cells, unit=unit, group={})))
    return runs


def list_single_columns(table: RawTable) -> list[str]:
    """Columns that are one trial each.

    They are beside the clock, and their names differ in a last part alone.

    That part is a letter, a number, or a load with its unit.
    """
    clocks = [column for column, _ in list_clocks(table)]
    others = [c for c in table.columns if c not in clocks and not c.startswith("column ")]
    stems = {re.sub(r"[ _-]?(\w|\d+)$", "", column) for column in others}
    loads = all(WITH_UNIT.fullmatch(column) for column in others)
    return others if len(others) > 1 and clocks and (len(stems) == 1 or loads) else []


def split_columns(table: RawTable) -> list[tuple[str, RawTable]]:
    """One table per column beside the clock.

    It has the column's name, and the column is called `value`.

    A name that is a load with its unit is stated as the key `load`.
    """
    clock = [column for column, _ in list_clocks(table)][:1]
    runs = []
    for column in [c for c in table.columns if c not in clock]:
        cells = table.cells[[*clock, column]].rename(columns={column: "value"})
        unit = {
            "value" if c == column else c: table.unit[c]
            for c in (*clock, column)
            if c in table.unit
        }
        stated = dict(table.stated)
        if found := WITH_UNIT.fullmatch(column):
            stated["load"] = (found[1], found[5])
        alone = replace(table, cells=cells, unit=unit, group={}, stated=stated)
        runs.append((column, alone))
    return runs
