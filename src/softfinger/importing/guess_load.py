"""Guesses of the load and of covariates."""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from softfinger.importing.build import read_stated
from softfinger.importing.cells import classify
from softfinger.importing.clock import list_clocks, read_times
from softfinger.importing.faults import ImportFault
from softfinger.importing.guess_motion import note_relabelled
from softfinger.importing.signals import LIKE_LOAD, SignalColumn, list_candidates
from softfinger.importing.trials import Run
from softfinger.importing.vocabulary import APPLIED, ENVIRONMENT, LOAD, find_quantity, score_words

if TYPE_CHECKING:
    from softfinger.importing.guess import Guesses


AXIS = re.compile(r"(?i)[ _.\-]?[xyz]$")
AT_REST = 0.4  # of a score: whether noise begins at rest is chance
EVENTS = 0.1  # rows of a load per row of the motion, below which they may be events


def guess_load(runs: Sequence[Run], guesses: Guesses) -> None:
    """Guess the load: column, stated key or motion."""
    run = runs[0]
    asked = [guesses.get(f"load.{key}") for key in ("column", "stated", "value")]
    if all(value is None for value in asked) and not guesses.get("load.none"):
        taken = [*(guesses.get("motion.columns") or ()), guesses.get("clock.column")]
        candidates = [c for c in list_candidates(run, LOAD, taken) if c.score >= LIKE_LOAD]
        if guesses.get("motion.quantity") in ("strain", "compliance"):
            candidates.sort(key=lambda c: c.quantity != "stress")
        stated = _find_stated_load(runs, str(guesses.get("motion.unit")))
        if candidates:
            best = _choose_axis(candidates)
            others = [c.column for c in candidates if c is not best][:3]
            why = f"not {', '.join(others)}" if others else "the column that fits best"
            guesses.put("load.column", best.column, why)
        elif stated:
            guesses.put("load.stated", stated[0], f"not {', '.join(stated[1:4])}" if stated[1:] else
                        "the only load that is stated")  # fmt: skip
        elif guesses.get("motion.quantity") == "compliance":
            guesses.put("load.value", 1.0, "a compliance is the motion under a unit load")
        else:
            guesses.put("load.none", True, "no column or key looks like a load")
    _complete_load(run, guesses)


def _choose_axis(candidates: Sequence[SignalColumn]) -> SignalColumn:
    """The best column that is no noise.

    Of the axes of one sensor it is the one that moves.
    """
    near = [c for c in candidates if c.score >= candidates[0].score - AT_REST]
    most = max(c.smooth for c in near)
    best = next((c for c in near if c.smooth >= 0.5 * most), candidates[0])
    stem = AXIS.sub("", best.column)
    axes = [c for c in candidates if AXIS.sub("", c.column) == stem != c.column]
    axes = [c for c in axes if (c.quantity, c.unit) == (best.quantity, best.unit)]
    return max(axes, key=lambda c: c.reach, default=best)


def _complete_load(run: Run, guesses: Guesses) -> None:
    if guesses.get("load.none"):
        return
    column, stated = guesses.get("load.column"), guesses.get("load.stated")
    own, name, quantity = "", column or stated or "", ""
    if column is not None:
        table, name = run.find(column)
        own = table.unit.get(name, "")
        topic = column.rpartition(": ")[0]
        quantity = find_quantity(name, own, LOAD)[0] or find_quantity(topic, own, LOAD)[0]
    elif stated is not None:
        own = str(run.stated.get(stated, ("", ""))[1])
        quantity = find_quantity(stated, own, LOAD)[0]
    elif guesses.get("motion.quantity") == "compliance":
        unit = str(guesses.get("motion.unit"))
        own = {"1/Pa": "Pa", "MPa^-1": "MPa", "1/MPa": "MPa", "1/kPa": "kPa"}.get(unit, "")
        name, quantity = "compliance", "stress"
    guesses.put("load.quantity", quantity or "load", f"from the name '{name}'")
    known = own not in ("", "-")
    note_relabelled("load", own, guesses)
    guesses.put("load.unit", own if known else "1", "as its heading states" if known else
                "none is stated")  # fmt: skip
    if column is not None and _is_of_events(run, column):
        guesses.put("load.between", "held", "few rows at uneven times, as events are logged")
    if column is None:
        guesses.put("load.from_s", 0.0, "a constant load acts from time 0 on")


def _is_of_events(run: Run, column: str) -> bool:
    """Whether a load has a row where it is changed, and no others."""
    table, name = run.find(column)
    clocks = [c for c, kind in list_clocks(table) if kind == "time"]
    longest = max(len(other.row) for other in run.tables.values())
    if not clocks or len(table.row) > EVENTS * longest:
        return False
    gaps = np.diff(read_times(table, clocks[0]).seconds)
    changed = np.diff(table.read_leniently(name)) != 0
    return bool(np.ptp(gaps) > 0.1 * np.max(gaps) and changed.mean() >= 0.5)


def _find_stated_load(runs: Sequence[Run], motion_unit: str) -> list[str]:
    """Keys that state all tables' load, best first."""
    scores = {}
    for key, (value, unit) in runs[0].stated.items():
        if classify(value) != "n" or not all(key in run.stated for run in runs):
            continue
        quantity, score = find_quantity(key, unit, LOAD)
        if score < 1.5:
            continue
        score += 1.0 * (score_words(key, APPLIED) == 2.0)
        wanted = "stress" if motion_unit in ("1", "percent", "-", "%") else "force"
        scores[key] = score + 0.7 * (quantity == wanted)
    return sorted(scores, key=lambda key: -scores[key])


def guess_covariates(runs: Sequence[Run], guesses: Guesses) -> None:
    """Note stated temperature, humidity, payload that differ."""
    if guesses.get("covariates") is not None:
        return
    found: dict[str, dict[str, str]] = {}
    for key, (value, unit) in runs[0].stated.items():
        quantity, score = find_quantity(key, unit, ENVIRONMENT)
        own = score_words(key, ENVIRONMENT.get(quantity, "")) == 2.0
        if not own or score < 0 or classify(value) != "n":
            continue
        try:
            values = [read_stated(run, key) for run in runs]
        except ImportFault:
            continue
        measured = score_words(key, "measured mean") == 2.0
        if np.ptp(values) > 0 and (quantity not in found or measured):
            found[quantity] = {"name": _name_covariate(key, unit), "stated": key}
    if found:
        why = ", ".join(covariate["stated"] for covariate in found.values())
        guesses.put("covariates", list(found.values()), f"{why}: stated of every trial")


def _name_covariate(key: str, unit: str) -> str:
    """Name of a column of trials.csv.

    The unit is its suffix.

    >>> _name_covariate("Measured Mean RH", "%"), _name_covariate("Temp", "°C")
    ('measured_mean_rh_pct', 'temp_c')
    """
    suffix = {"%": "pct", "°C": "c", "degC": "c", "": "", "-": "", "1": ""}.get(unit, unit)
    words = re.findall(r"\w+", f"{key} {suffix}".lower())
    return "_".join(words)
