"""Columns that may be a load or a motion."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from softfinger.importing.clock import list_clocks
from softfinger.importing.points import list_point_columns
from softfinger.importing.trials import Run
from softfinger.importing.vocabulary import LOAD, MOTION, find_quantity, score_words

LIKE_LOAD = 1.4  # of a column's score


class SignalColumn(NamedTuple):
    """A column that may be a signal."""

    column: str
    quantity: str
    score: float
    unit: str
    reach: float  # from its least number to its largest
    smooth: float  # 1 of a slow signal, 0 of white noise: by von Neumann's ratio


def list_candidates(
    run: Run, role: dict[str, str], taken: Sequence[str] = ()
) -> list[SignalColumn]:
    """Columns of numbers for a role, best first."""
    found = []
    for topic, table in run.tables.items():
        clocks = [column for column, _ in list_clocks(table)]
        owned = list_point_columns(table.columns)
        for column in table.columns:
            whole = f"{topic}: {column}" if len(run.tables) > 1 else column
            if whole in taken or column in clocks[:1] or column in taken or column in owned:
                continue
            unit = table.unit.get(column, "")
            quantity, score = find_quantity(column, unit, role)
            if len(run.tables) > 1:
                by_topic, more = find_quantity(topic, unit, role)
                if more > score:
                    quantity, score = by_topic, more
                score += 0.25 * max(score_words(column, "data value"), 0.0)
            values = table.read_leniently(column)
            seen = values[np.isfinite(values)]
            if score <= 0.0 or seen.size < 0.2 * values.size or not seen.size:
                continue
            moving = 0.5 if np.ptp(seen) > 0 else -0.5
            if role is LOAD and abs(seen[0]) <= 0.1 * np.ptp(seen):
                moving += 0.3  # it begins at rest
            if moving < 0 and role is MOTION:
                continue
            reach, smooth = float(np.ptp(seen)), measure_smoothness(seen)
            found.append(SignalColumn(whole, quantity, score + moving, unit, reach, smooth))
    return sorted(found, key=lambda candidate: -candidate.score)


def measure_smoothness(values: np.ndarray) -> float:
    """Share of values (row,) that lasts from row to row.

    >>> measure_smoothness(np.arange(100.0)) > 0.99, measure_smoothness(np.resize([0, 1], 100)) < 0
    (True, True)
    """
    spread = float(np.var(values))
    return 1.0 - float(np.mean(np.diff(values) ** 2)) / (2.0 * spread) if spread > 0.0 else 0.0


def follow_load(run: Run, column: str) -> float:
    """Correlation of a column with its table's likeliest load.

    It is 0 where there is none, or one of them is constant.
    """
    table, name = run.find(column)
    loads = list_candidates(Run(run.name, {"": table}), LOAD, [name])
    if not loads or loads[0].score < LIKE_LOAD:
        return 0.0
    pair = np.array([table.read_leniently(each) for each in (name, loads[0].column)])
    pair = pair[:, np.isfinite(pair).all(axis=0)]
    varies = pair.shape[1] > 1 and np.ptp(pair, axis=1).all()
    return abs(float(np.corrcoef(pair)[0, 1])) if varies else 0.0


def measure_jump(run: Run, column: str) -> float:
    """Largest change from row to row, as a share of all change."""
    table, name = run.find(column)
    values = table.read_leniently(name)
    seen = values[np.isfinite(values)]
    return float(np.abs(np.diff(seen)).max() / np.ptp(seen))
