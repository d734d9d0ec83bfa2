"""The evidence of a verdict.

It shows the gain of every effect, and what models leave.
"""

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from softfinger.figures.repair import MODEL_STYLES
from softfinger.figures.style import (
    BLUE,
    GREY,
    PALE,
    SINGLE_COLUMN,
    get_source,
    label_log_axis,
    new_figure,
    styled,
)

MOST_ROWS, FEW_ROWS = 20, 7
JOINT_MARKS = "os^dvP*X"


@styled
def draw_evidence(ranking: xr.Dataset, evidence: xr.Dataset, misfit: xr.Dataset) -> Figure:
    """Draw the effects of most gain, and what models leave.

    Left: `draw_ranking` of few effects. Right: mean square of what each model leaves of all
    trials over that of the noise, against the time since the load changed; 1 is noise alone.

    Parameters
    ----------
    ranking, evidence
        As for `draw_ranking`.
    misfit
        mean_square (model, joint, since_change).
    """
    figure = new_figure(get_source(ranking), 2.4)
    left, right = figure.subplots(1, 2, width_ratios=[1.1, 1])
    draw_gains(left, ranking, evidence, FEW_ROWS)
    draw_misfit(right, misfit)
    for ax in (left, right):
        ax.legend(loc="upper center", bbox_to_anchor=(0.5, -0.26), ncols=2)
    return figure


@styled
def draw_ranking(ranking: xr.Dataset, evidence: xr.Dataset) -> Figure:
    """Draw every effect's gain over the base model.

    What chance gains is drawn beside it.

    Parameters
    ----------
    ranking
        best_gain (effect) and needed_gain () [nats].
    evidence
        needed (effect), chance_range (end) [nats].
    """
    rows = min(max(ranking.sizes["effect"], 3), MOST_ROWS)
    figure = new_figure(get_source(ranking), 1.0 + 0.17 * rows, SINGLE_COLUMN)
    ax = figure.subplots()
    draw_gains(ax, ranking, evidence, MOST_ROWS)
    figure.legend(*ax.get_legend_handles_labels(), loc="outside lower center", ncols=2)
    return figure


def draw_gains(ax: Axes, ranking: xr.Dataset, evidence: xr.Dataset, most: int) -> None:
    """Draw the gain of the `most` best effects [nats]."""
    order = np.argsort(-ranking["best_gain"].values, kind="stable")[:most]
    shown = ranking.isel(effect=order[::-1])
    rows = np.arange(order.size)
    gain = shown["best_gain"].values
    included = evidence["needed"].sel(effect=shown["effect"]).values
    ax.axvspan(*evidence["chance_range"].values, color=PALE, lw=0, label="what chance gains")
    ax.axvline(float(ranking["needed_gain"]), color=GREY, ls=":", label="believed from here")
    ax.hlines(rows, 0.0, gain, color=GREY, lw=0.6, label="_gain")
    ax.plot(gain[~included], rows[~included], "o", mfc="white", color=GREY, label="not needed")
    ax.plot(gain[included], rows[included], "o", color=BLUE, label="needed (probability > ½)")
    ax.set_yticks(rows, [str(name).replace("_", " ") for name in shown["effect"].values])
    ax.set_xscale("symlog", linthresh=1.0)
    ax.margins(x=0.06)
    ax.set_xlabel("log evidence over the base model, alone [nats]")
    ax.grid(axis="y", visible=False)


def draw_misfit(ax: Axes, misfit: xr.Dataset) -> None:
    """Draw squared residuals over squared noise of all trials.

    The axis is the time since the load changed; each joint has its mark.
    """
    ax.axhline(1.0, color=GREY, lw=0.7, label="_")
    for model in misfit["model"].values:
        colour, line, label = MODEL_STYLES[str(model)]
        for k, joint in enumerate(misfit["joint"].values):
            mean = misfit["mean_square"].sel(model=model, joint=joint).values
            ax.plot(misfit["since_change"].values, mean, line, color=colour, lw=0.8, ms=3,
                    marker=JOINT_MARKS[k % len(JOINT_MARKS)],
                    label=f"{label}, joint {joint}")  # fmt: skip
    ax.set(xscale="log", yscale="log")
    label_log_axis(ax.xaxis)
    label_log_axis(ax.yaxis)
    ax.set_xlabel("time since the load changed [s]")
    ax.set_ylabel("squared residual over noise [1]")
