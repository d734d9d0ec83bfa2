"""The benchmarks' page: every figure of results/benchmarks.json beside its goal, and a picture."""

from __future__ import annotations

import json
from pathlib import Path

from benchmarks._goals import GOALS
from inline_picture import embed_figure
from matplotlib.figure import Figure

from softfinger.figures.style import BLUE, GREY, RED, styled
from softfinger.provenance import PROJECT

RESULTS = PROJECT / "results/benchmarks.json"


def describe_benchmarks(results: Path = RESULTS) -> str:
    """Picture and table of the measured figures; a sentence where none were measured."""
    if not results.is_file():
        return "No benchmark has been run in this checkout: `make benchmark` writes the figures."
    measured = json.loads(results.read_text(encoding="utf-8"))
    lines = ["| key | what | measured | goal | |", "| --- | --- | --- | --- | --- |"]
    for key, goal in GOALS.items():
        value = measured.get(key)
        shown = "not measured" if value is None else f"{value:.3g}"
        verdict = "" if value is None else "met" if goal.is_met(value) else "missed"
        lines.append(f"| `{key}` | {goal.what} | {shown} | {goal.words} | {verdict} |")
    rest = sorted(set(measured) - set(GOALS))
    more = ["| key | measured |", "| --- | --- |"]
    more += [f"| `{key}` | {measured[key]:.3g} |" for key in rest]
    parts = [draw_margins(measured), "\n".join(lines)]
    if rest:
        parts += ["Figures without a goal, some of which the ratios are made of:", "\n".join(more)]
    return "\n\n".join(parts)


def draw_margins(measured: dict[str, float]) -> str:
    """Draw how many times better or worse than its goal each figure is, as an inline picture."""
    margins = {
        key: margin
        for key, goal in GOALS.items()
        if key in measured and (margin := goal.find_margin(measured[key])) is not None
    }
    if not margins:
        return ""
    words = "; ".join(f"{key} {margin:.3g} times its goal" for key, margin in margins.items())
    return embed_figure(plot_margins(margins), f"Measured figures over their goals: {words}")


@styled
def plot_margins(margins: dict[str, float]) -> Figure:
    """Plot one line per figure, from its goal to what was measured."""
    figure = Figure(figsize=(7.0, 0.6 + 0.22 * len(margins)), layout="constrained")
    axes = figure.subplots()
    names, values = list(margins)[::-1], list(margins.values())[::-1]
    colours = [BLUE if value >= 1 else RED for value in values]
    axes.hlines(range(len(values)), 1, values, colors=colours)
    axes.scatter(values, range(len(values)), c=colours, zorder=3)
    axes.axvline(1, color=GREY)
    axes.set_xscale("log")
    axes.set_yticks(range(len(values)), names)
    axes.set_xlabel("times better than the goal; right of the line it is met")
    return figure
