"""Guesses of the motion, its unit and start."""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from softfinger.campaign.units import is_unit, parse_unit
from softfinger.importing.clock import list_clocks
from softfinger.importing.faults import ImportFault
from softfinger.importing.points import Point, choose_camera, find_points
from softfinger.importing.signals import SignalColumn, follow_load, list_candidates, measure_jump
from softfinger.importing.trials import Run
from softfinger.importing.vocabulary import (
    LOAD,
    MOTION,
    find_quantity,
    is_alike,
    list_tokens,
    score_words,
)

if TYPE_CHECKING:
    from softfinger.importing.guess import Guesses

LIKELY = 0.6  # the least likelihood at which DeepLabCut's own plots show a point
ALIKE = 0.1  # of a score, which the order of words decides
UNITS = {
    "angle": "rad", "strain": "1", "compliance": "1", "position": "1", "displacement": "1",
    "curvature": "1", "sensor": "1",
}  # fmt: skip


def guess_motion(runs: Sequence[Run], guesses: Guesses) -> None:
    """Guess the columns or points of the motion.

    Raises
    ------
    ImportFault
        Nothing looks like a motion.
    """
    run = runs[0]
    if guesses.get("motion.columns") is None and guesses.get("motion.points") is None:
        taken = [c for c in (guesses.get("load.column"), guesses.get("clock.column")) if c]
        candidates = list_candidates(run, MOTION, taken)
        points = _list_points(run, guesses)
        good = [c for c in candidates if c.score >= 2.0]
        if points and not any(c.quantity not in ("position", "sensor") for c in good):
            guesses.put("motion.points.names", _order(points), "their coordinates are logged")
        elif good or candidates:
            _choose_columns(run, good or candidates, guesses)
        else:
            _choose_only_column(run, guesses)
    if guesses.get("motion.points") is not None:
        _complete_points(run, guesses)
    else:
        column = guesses.get("motion.columns")[0]
        table, name = run.find(column)
        own = table.unit.get(name, "")
        quantity = find_quantity(name, own, MOTION)[0] or "motion"
        declared = guesses.get("motion.unit")
        if quantity == "motion" and declared and is_alike(declared, "rad"):
            quantity = "angle"
        guesses.put("motion.quantity", quantity, f"from the name '{name}'")
        quantity = str(guesses.get("motion.quantity"))
        unit = own if own not in ("", "-") else _find_usual_unit(run, column, quantity)
        why = "as its heading states" if own not in ("", "-") else "none is stated"
        note_relabelled("motion", own, guesses)
        guesses.put("motion.unit", unit, why)
        _refuse_several(guesses)
    guesses.put("motion.start", *_find_start(runs, guesses))


def note_relabelled(kind: str, own: str, guesses: Guesses) -> None:
    """State that a declared unit is not the heading's."""
    declared = guesses.get(f"{kind}.unit")
    stated = own not in ("", "-") and is_unit(own)
    if declared is not None and stated and parse_unit(own) != parse_unit(declared):
        guesses.said.append(
            f"{kind}.unit: {declared}, as declared; the heading states {own}, and no number is "
            "converted"
        )


def _refuse_several(guesses: Guesses) -> None:
    """Refuse several columns of a specimen."""
    columns, quantity = guesses.get("motion.columns"), guesses.get("motion.quantity")
    if len(columns) > 1 and quantity != "angle":
        raise ImportFault(
            f"motion.columns: {len(columns)} columns of the quantity '{quantity}'; a specimen has "
            "one; for the joints of a finger type motion: {quantity: angle, unit: rad}"
        )


def _find_usual_unit(run: Run, column: str, quantity: str) -> str:
    """Usual unit of a quantity, by its size."""
    if quantity != "angle":
        return UNITS.get(quantity, "1")
    table, name = run.find(column)
    values = table.read_leniently(name)
    return "deg" if np.nanmax(np.abs(values)) > 2 * np.pi else "rad"


def _list_points(run: Run, guesses: Guesses) -> list[Point]:
    table = max(run.tables.values(), key=lambda t: len(find_points(t.columns)))
    points, other = choose_camera(find_points(table.columns))
    if other:
        names = ", ".join(point.name for point in other)
        guesses.said.append(f"motion.points: {names} are seen by a second camera and not used")
    return points


def _order(points: Sequence[Point]) -> list[str]:
    """Names from base to tip."""
    names = [point.name for point in points]
    tip = [score_words(name, "tip end spitze") > 0 for name in names]
    base = [score_words(name, "base root origin basis pivot") > 0 for name in names]
    return names[::-1] if (tip[0] and not tip[-1]) or (base[-1] and not base[0]) else names


def _complete_points(run: Run, guesses: Guesses) -> None:
    """Guess how points are read, and lost ones."""
    if guesses.get("motion.points.names") is None:
        guesses.put(
            "motion.points.names", _order(_list_points(run, guesses)), "all that are logged"
        )
    names = list(guesses.get("motion.points.names"))
    table = max(run.tables.values(), key=lambda t: len(find_points(t.columns)))
    known = {point.name: point for point in find_points(table.columns)}
    unknown = [name for name in names if name not in known]
    if unknown:
        raise ImportFault(f"motion.points.names: no '{unknown[0]}'; there are {', '.join(known)}")
    points = [known[name] for name in names]
    unit = table.unit.get(points[0].x, "")
    many = "markers" if len(points) > 2 else "direction" if len(points) == 2 else "displacement"
    why = {
        "markers": "a chain of three points or more, base to tip",
        "direction": "the line between two points turns",
        "displacement": "one point moves along a line",
    }
    guesses.put("motion.points.read_as", many, why[many])
    zero = any(
        _is_zero_at_times(table.read_leniently(p.x), table.read_leniently(p.y)) for p in points
    )
    guesses.put("motion.points.lost", "zero" if zero else "empty", "as the rows look")
    if any(p.trust and np.nanmax(table.read_leniently(p.trust)) <= 1.0 for p in points):
        guesses.put("motion.points.least_trust", LIKELY, "DeepLabCut's own cut")
    length = unit not in ("", "1", "px", "pixel")
    guesses.put(
        "motion.points.up",
        "y" if length else "-y",
        "pictures count rows downwards" if not length else "lengths are taken to point up",
    )
    angle = guesses.get("motion.points.read_as") != "displacement"
    guesses.put("motion.quantity", "angle" if angle else "displacement", "from points")
    guesses.put("motion.unit", "rad" if angle else (unit or "pixel"), "from points")


def _is_zero_at_times(x: np.ndarray, y: np.ndarray) -> bool:
    zero = (x == 0.0) & (y == 0.0)
    others = np.hypot(x, y)[~zero & np.isfinite(x) & np.isfinite(y)]
    return bool(zero.any() and others.size and others.min() > 0.02 * others.max())


def _choose_columns(run: Run, candidates: Sequence[SignalColumn], guesses: Guesses) -> None:
    """Choose the best column, or all numbered angles.

    Of columns that fit alike, as roll and pitch do, it is the one that moves most, of those that
    move with the load where one does.
    """
    first = candidates[0]
    alike = [c for c in candidates if (c.quantity, c.unit) == (first.quantity, first.unit)]
    others = [c for c in alike if _stem(c.column) != _stem(first.column)]
    near = [first, *(c for c in others if c.score >= first.score - ALIKE)]
    follows = [follow_load(run, c.column) for c in near] if len(near) > 1 else [0.0]
    moved = [c for c, r in zip(near, follows, strict=True) if r >= 0.5 * max(follows)]
    best = max(moved, key=lambda c: c.reach)
    rivals = [c.column for c in candidates[1:] if c.score >= best.score - 0.6]
    columns = [best.column]
    if best.quantity == "angle":
        alike = [c for c in candidates if _stem(c.column) == _stem(best.column)]
        columns = [c.column for c in sorted(alike, key=lambda c: _number(c.column))]
    others = [column for column in rivals if column not in columns]
    why = f"not {', '.join(others[:4])}" if others else "the column that fits best"
    guesses.put("motion.columns", columns, why)
    guesses.put("motion.quantity", best.quantity, f"from the name '{best.column}'")


def _stem(name: str) -> tuple[str, ...]:
    return tuple(token for token in list_tokens(name) if not token.isdigit())


def _number(name: str) -> tuple[int, ...]:
    return tuple(int(number) for number in re.findall(r"\d+", name))


def _choose_only_column(run: Run, guesses: Guesses) -> None:
    """Take the only column of numbers that moves."""
    moving = []
    for topic, table in run.tables.items():
        clocks = [column for column, _ in list_clocks(table)]
        for column in table.columns:
            values = table.read_leniently(column)
            seen = values[np.isfinite(values)]
            if column not in clocks and seen.size > 0.5 * values.size and np.ptp(seen) > 0:
                moving.append(f"{topic}: {column}" if topic else column)
    load = guesses.get("load.column") or next(
        (c.column for c in list_candidates(run, LOAD) if c.score >= 2.0), None
    )
    moving = [column for column in moving if column != load]
    if not moving:
        raise ImportFault(
            f"trial {run.name}: no column looks like a motion; there are {', '.join(run.columns)}; "
            "type motion: {columns: [NAME], unit: UNIT} in import.yaml, or trials: {by: folder} if "
            "its motion is in another file"
        )
    if len(moving) > 1 and all(column.split(": ")[-1].startswith("column ") for column in moving):
        load, motion = sorted(moving[:2], key=lambda column: -measure_jump(run, column))
        raise ImportFault(
            f"trial {run.name}: {', '.join(moving)} have no names; which is the load, which the "
            f"motion? If {load} jumps as a load does, type --set \"load.column='{load}'\" --set "
            f"\"motion.columns=['{motion}']\" --set motion.unit=UNIT"
        )
    why = "the only column that moves" if len(moving) == 1 else f"not {', '.join(moving[1:4])}"
    guesses.put("motion.columns", moving[:1], why)


def _find_start(runs: Sequence[Run], guesses: Guesses) -> tuple[str, str]:
    """Guess from where a motion is measured."""
    columns = guesses.get("motion.columns")
    if not columns or guesses.get("motion.quantity") in ("angle", "strain", "compliance"):
        return "as recorded", "its zero is its own"
    far = []
    for run in runs:
        table, name = run.find(columns[0])
        values = table.read_leniently(name)
        seen = values[np.isfinite(values)]
        if seen.size:
            far.append(abs(seen[0]) > 3.0 * np.ptp(seen))
    if far and np.mean(far) > 0.5:
        return "first row", "it begins far from 0"
    return "as recorded", "it begins near 0"
