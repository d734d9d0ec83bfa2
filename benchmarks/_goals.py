"""The goals of `goals.yaml`, and the table of them that a run of the benchmarks ends with."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import NamedTuple

from ruamel.yaml import YAML

from softfinger.provenance import PROJECT

CLEAN = "clean_campaigns", "clean_conditions", "clean_false_", "measurement_"
PROOFS = {
    "concealed": ("concealed_", "nuisance_", "law_", *CLEAN),
    "concealed_long": ("concealed_", "nuisance_", "law_", *CLEAN),
    "concealed_clean": CLEAN,
    "concealed_twins": ("nuisance_",),
    "concealed_foreign": ("law_",),
}
"""Folders of proofs, and beginnings of the keys that each measures; a later one counts more."""


class Goal(NamedTuple):
    """What a key measures, the range that it should lie in, its rival's key, who measures it."""

    what: str
    at_least: float | None = None
    at_most: float | None = None
    rival: str | None = None
    by: str = "benchmark"

    @property
    def words(self) -> str:
        """The range in words."""
        if self.at_least is None:
            return "known" if self.at_most is None else f"≤ {self.at_most:g}"
        if self.at_most is None:
            return f"≥ {self.at_least:g}"
        return f"{self.at_least:g} to {self.at_most:g}"

    def is_met(self, value: float) -> bool:
        """Whether a figure lies in the range."""
        low = self.at_least is None or value >= self.at_least
        return low and (self.at_most is None or value <= self.at_most)

    def find_margin(self, value: float) -> float | None:
        """How many times better than a one-sided goal; None for a range, or a value of 0."""
        if value == 0 or (self.at_least is None) == (self.at_most is None):
            return None
        return value / self.at_least if self.at_most is None else self.at_most / value


GOALS = {
    key: Goal(**entry)
    for key, entry in YAML(typ="safe").load(Path(__file__).with_name("goals.yaml")).items()
}


def read_proofs(results: Path = PROJECT / "results") -> dict[str, float]:
    """Figures of the proofs that were run in this checkout, the newest seed of each."""
    figures: dict[str, float] = {}
    for proof, beginnings in PROOFS.items():
        found = sorted((results / proof).glob("seed_*/benchmarks.json"), key=_get_age)
        if found:
            told = json.loads(found[-1].read_text(encoding="utf-8"))
            figures |= {key: value for key, value in told.items() if key.startswith(beginnings)}
    return figures


def _get_age(path: Path) -> float:
    return path.stat().st_mtime


def list_rows(measured: Mapping[str, float]) -> Iterator[tuple[str, str, str, str, str]]:
    """Key, goal, value, verdict and rival of every goal; a key without a value is absent."""
    for key, goal in GOALS.items():
        value = measured.get(key)
        rival = "" if goal.rival not in measured else f"{measured[goal.rival]:.4g}"
        if value is None:
            yield key, goal.words, "absent", f"make {goal.by}", rival
        else:
            met = "" if goal.words == "known" else "met" if goal.is_met(value) else "missed"
            yield key, goal.words, f"{value:.4g}", met, rival


def print_table(measured: Mapping[str, float]) -> None:
    """Print goal, value and rival of every key."""
    rows = [("key", "goal", "value", "", "rival"), *list_rows(measured)]
    widths = [max(len(row[column]) for row in rows) for column in range(5)]
    for row in rows:
        print("  ".join(f"{cell:<{width}}" for cell, width in zip(row, widths, strict=True)))
