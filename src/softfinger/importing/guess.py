"""Guesses of what a description leaves open, listed."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from softfinger.importing.clock import list_clocks, read_times
from softfinger.importing.description import ImportDescription
from softfinger.importing.faults import ImportFault
from softfinger.importing.guess_load import guess_covariates, guess_load
from softfinger.importing.guess_motion import guess_motion
from softfinger.importing.guess_trials import guess_trials
from softfinger.importing.points import find_points
from softfinger.importing.table import RawTable
from softfinger.importing.trials import Run, split_trials


@dataclass
class Guesses:
    """A description as it fills up, with reasons."""

    content: dict[str, Any]
    said: list[str] = field(default_factory=list)

    def get(self, key: str) -> Any:  # noqa: ANN401
        """Value of a dotted key; None where open."""
        node: Any = self.content
        for part in key.split("."):
            node = node.get(part) if isinstance(node, dict) else None
        return node

    def put(self, key: str, value: object, why: str) -> None:
        """Fill an open key; what is declared stays."""
        if self.get(key) is not None:
            return
        *path, last = key.split(".")
        node = self.content
        for part in path:
            if not isinstance(node.get(part), dict):
                node[part] = {}
            node = node[part]
        node[last] = value
        self.said.append(f"{key}: {_spell(value)} ({why})")


def _spell(value: object) -> str:
    if isinstance(value, (list, tuple)):
        return "[" + ", ".join(map(_spell, value)) + "]"
    return str(value).lower() if isinstance(value, bool) else str(value)


def complete(
    tables: Sequence[RawTable], description: ImportDescription, name: str
) -> tuple[ImportDescription, list[Run], list[str], list[str]]:
    """Fill what a description leaves open.

    Returns
    -------
    description : Description
        With nothing open.
    guessed, dropped : list of str
        A sentence each: ``key: value (why)``, and what is left out.

    Raises
    ------
    ImportFault
        Something cannot be guessed; the message gives the key to type.
    """
    guesses = Guesses(description.model_dump(exclude_none=True, exclude_unset=True))
    guesses.put("name", name, "the name of the source")
    tables, dropped = guess_trials(tables, guesses)
    described = ImportDescription.model_validate(guesses.content)
    runs = split_trials(tables, described, str(guesses.get("name")))
    first = runs[0]
    _guess_clock(first, guesses)
    guess_motion(runs, guesses)
    guess_load(runs, guesses)
    guess_covariates(runs, guesses)
    _guess_start(runs, guesses)
    dropped += _list_unused(first, guesses)
    return ImportDescription.model_validate(guesses.content), runs, guesses.said, dropped


def _guess_clock(run: Run, guesses: Guesses) -> None:
    """Guess the column of the clock and its unit."""
    if guesses.get("clock.column") is None:
        found = {k: list_clocks(table) for k, table in run.tables.items()}
        best = [clocks[0] for clocks in found.values() if clocks]
        same = len({column for column, _ in best}) == 1
        if best and same:
            column, kind = best[0]
            others = [c for clocks in found.values() for c, _ in clocks[1:]]
            why = f"not {', '.join(dict.fromkeys(others))}" if others else "the only clock"
            rated = guesses.get("clock.frames_per_second") or guesses.get("clock.interval_s")
            counted = kind == "time" if len(found) > 1 or not rated else kind == "frame"
            if counted:  # a rate that is declared takes the place of a clock
                guesses.put("clock.column", column, why)
    column = guesses.get("clock.column")
    rated = guesses.get("clock.frames_per_second") or guesses.get("clock.interval_s")
    if column is None or rated:
        return
    table, name = run.find(column) if len(run.tables) == 1 else _first_with(run, column)
    if len({other.unit.get(name) for other in run.tables.values() if name in other.cells}) > 1:
        guesses.said.append(f"clock: '{name}' is in each file's own unit")
    elif guesses.get("clock.unit") is None:
        own = table.unit.get(name)
        unit = read_times(table, name).unit
        if unit in ("date", "time of day"):
            guesses.said.append(f"clock: its cells are read as {unit}")
        else:
            why = "as its heading states" if own else _explain_unit(unit)
            guesses.put("clock.unit", unit, why)


def _explain_unit(unit: str) -> str:
    return "none is stated" if unit == "s" else "from the size of its numbers"


def _first_with(run: Run, column: str) -> tuple[RawTable, str]:
    name = column.rpartition(": ")[2]
    for table in run.tables.values():
        if name in table.cells:
            return table, name
    raise ImportFault(f"clock.column: there is no column '{column}'")


def _guess_start(runs: Sequence[Run], guesses: Guesses) -> None:
    """Count times from the first row, if needed."""
    late, apart, column = 0, 0, guesses.get("clock.column")
    for run in runs:
        dated = set()
        for table in run.tables.values():
            name = (column or "").rpartition(": ")[2]
            clocks = (
                [name] if name in table.cells else [c for c, k in list_clocks(table) if k == "time"]
            )
            if not clocks:
                continue
            times = read_times(table, clocks[0], guesses.get("clock.unit"))
            seen = times.seconds[np.isfinite(times.seconds)]
            late += bool(seen.size and abs(seen.min()) > 0.5 * np.ptp(seen))
            dated.add(times.zero is not None)
        apart += len(dated) > 1
    if apart:
        why = "the clocks have nothing in common; both are taken to start at once"
        guesses.put("clock.start", "each first row", why)
    elif late:
        guesses.put("clock.start", "first row", "the clock began long before")
    else:
        guesses.put("clock.start", "as recorded", "it begins near 0")


def _list_unused(run: Run, guesses: Guesses) -> list[str]:
    """Columns that nothing is made of."""
    named = set(guesses.get("motion.columns") or ())
    named |= {guesses.get(k) for k in ("load.column", "clock.column", "trials.column")} - {None}
    named |= {c.get("column") for c in guesses.get("covariates") or ()}
    wanted = guesses.get("motion.points.names") or ()
    for point in find_points(next(iter(run.tables.values())).columns):
        named |= {point.x, point.y, point.trust} if point.name in wanted else set()
    unused = [c for c in run.columns if not {c, c.rpartition(": ")[2]} & named]
    return [f"column '{column}': it is not used" for column in unused]
