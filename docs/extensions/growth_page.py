"""The page on growth: cost against the number of trials, from benchmarks/growth.json."""

from __future__ import annotations

import json
from pathlib import Path

from benchmarks._goals import GOALS
from inline_picture import embed_figure
from matplotlib.figure import Figure
from matplotlib.ticker import NullFormatter

from softfinger.figures.style import BLUE, GREY, RED, styled
from softfinger.provenance import PROJECT

RESULTS = PROJECT / "benchmarks/growth.json"
COLUMNS = {
    "trials": "trials",
    "track_cpu_seconds": "tracking, CPU seconds",
    "track_memory_gib": "its memory [GiB]",
    "seconds": "fit, wall seconds",
    "cpu_seconds": "CPU seconds",
    "prepare_seconds": "of the wall seconds, preparing",
    "compile_seconds": "compiling",
    "sample_seconds": "sampling",
    "memory_gib": "memory [GiB]",
    "report_mib": "report [MiB]",
    "r_hat": "largest R-hat",
    "effective_draws": "fewest effective draws",
}


def read_growth(results: Path = RESULTS) -> list[dict[str, float]]:
    """Measured costs, one row per number of trials, fewest first."""
    measured = json.loads(results.read_text(encoding="utf-8"))
    rows = [{"trials": int(trials), **costs} for trials, costs in measured.items()]
    return sorted(rows, key=lambda row: row["trials"])


def describe_growth(results: Path = RESULTS) -> str:
    """Picture and table of the measured costs."""
    rows = read_growth(results)
    words = "; ".join(
        f"{row['trials']} trials: {row['cpu_seconds']:.3g} CPU seconds, {row['memory_gib']:.2g} GiB"
        for row in rows
    )
    lines = [f"| {' | '.join(COLUMNS.values())} |", f"|{' --- |' * len(COLUMNS)}"]
    lines += [f"| {' | '.join(_write(row.get(key)) for key in COLUMNS)} |" for row in rows]
    picture = embed_figure(
        plot_growth(rows), f"Cost of a fit against the number of trials: {words}"
    )
    return "\n\n".join([picture, "\n".join(lines)])


def _write(cost: float | None) -> str:
    return "" if cost is None else f"{cost:.3g}"


@styled
def plot_growth(rows: list[dict[str, float]]) -> Figure:
    """Plot CPU time and memory against the number of trials, beside the goals for 10000."""
    figure = Figure(figsize=(7.0, 2.8), layout="constrained")
    trials = [row["trials"] for row in rows]
    # Two cores that are kept busy for the goal's seconds of wall time.
    seconds = 2 * (GOALS["posterior_10000_trials_seconds"].at_most or 0.0)
    memory = GOALS["posterior_10000_trials_gib"].at_most
    panels = (("cpu_seconds", "CPU time [s]", seconds), ("memory_gib", "memory [GiB]", memory))
    for axes, (key, label, goal) in zip(figure.subplots(1, 2), panels, strict=True):
        axes.plot(trials, [row[key] for row in rows], "o-", color=BLUE, label="fit")
        tracked = [row for row in rows if f"track_{key}" in row]
        filmed, costs = [r["trials"] for r in tracked], [r[f"track_{key}"] for r in tracked]
        axes.plot(filmed, costs, "s--", color=GREY, label="tracking")
        axes.plot(10_000, goal, "_", color=RED, markersize=18, label="goal for 10000 trials")
        axes.set(xscale="log", yscale="log", xlabel="trials", ylabel=label)
        axes.yaxis.set_minor_formatter(NullFormatter())
        axes.grid(color=GREY, alpha=0.2)
        axes.legend(loc="upper left")
    return figure
