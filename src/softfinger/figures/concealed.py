"""Figures of the proof."""

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from softfinger.figures.style import (
    BLUE,
    GREEN,
    GREY,
    PALE,
    RED,
    SINGLE_COLUMN,
    get_source,
    new_figure,
    styled,
)

VISIBLE_NATS = 15.0
WEAKEST, STRONGEST = 0.5, 3e4
"""Ends of the axis of evidence [nats]."""


@styled
def draw_right_by_evidence(score: xr.Dataset) -> Figure:
    """Draw right names against the oracle's evidence.

    Parameters
    ----------
    score
        From `softfinger.concealed.score`.
    """
    figure = new_figure(get_source(score), height=2.8)
    ax = figure.subplots()
    listed = score["listed"].values
    gain = np.clip(score["gain"].values[listed], WEAKEST, STRONGEST)
    right = score["right"].values[listed].astype(float)
    jitter = 0.02 * np.sin(np.arange(right.size) * 2.4)
    ax.plot(gain, right + jitter, "o", color=GREY, markersize=3, alpha=0.6, label="a campaign")
    edges = np.append(score["gain_bin"].values, score["gain_bin_end"].values[-1])
    middle = np.sqrt(np.prod(np.clip([edges[:-1], edges[1:]], WEAKEST, STRONGEST), axis=0))
    share, counted = score["right_by_gain"].values, score["count_by_gain"].values > 0
    reach = np.abs([score[f"right_by_gain_{end}"].values - share for end in ("lower", "upper")])
    ax.errorbar(
        middle[counted], share[counted], reach[:, counted],
        fmt="o-", color=BLUE, capsize=2, label="the diagnosis, 95 % interval",
    )  # fmt: skip
    ax.plot(
        middle[counted], score["could_by_gain"].values[counted],
        "s--", color=GREEN, markersize=4, label="the oracle's own limit",
    )  # fmt: skip
    ax.axvline(VISIBLE_NATS, color=RED, linewidth=0.8, label="visible from here on")
    ax.set(
        xscale="log",
        xlabel="oracle's evidence for what was concealed [nats]",
        ylabel="share answered right",
        ylim=(-0.06, 1.06),
    )
    figure.legend(loc="outside lower center", ncols=3)
    return figure


@styled
def draw_confusion(score: xr.Dataset) -> Figure:
    """Draw how often each truth got each answer."""
    counts = score["confusion"]
    counts = counts.isel(
        truth=np.flatnonzero(counts.sum("answer").values),
        answer=np.flatnonzero(counts.sum("truth").values),
    )
    rows, columns = counts.shape
    figure = new_figure(get_source(score), height=1.2 + 0.24 * rows)
    ax = figure.subplots()
    rows_share = counts / counts.sum("answer")
    ax.pcolormesh(
        rows_share.values, cmap="Blues", vmin=0.0, vmax=1.6, edgecolors="white", linewidth=0.8
    )
    for row in range(rows):
        for column in range(columns):
            if count := int(counts.values[row, column]):
                ax.text(column + 0.5, row + 0.5, f"{count}", ha="center", va="center")
    ax.set_xticks(np.arange(columns) + 0.5, _plain(counts["answer"]), rotation=40, ha="right")
    ax.set_yticks(np.arange(rows) + 0.5, _plain(counts["truth"]))
    ax.invert_yaxis()
    ax.set(xlabel="answered", ylabel="concealed")
    ax.grid(visible=False)
    return figure


def _plain(words: xr.DataArray) -> list[str]:
    return [str(word).replace("_", " ") for word in words.values]


@styled
def draw_reliability(score: xr.Dataset) -> Figure:
    """Draw the frequency of effects against their stated probability."""
    figure = new_figure(get_source(score), height=2.8, width=SINGLE_COLUMN)
    ax = figure.subplots()
    ax.plot([0, 1], [0, 1], color=PALE)
    stated, true = score["stated_probability"].values, score["true_share"].values
    reach = np.abs([score[f"true_share_{end}"].values - true for end in ("lower", "upper")])
    counted = score["stated_count"].values > 0
    ax.errorbar(stated[counted], true[counted], reach[:, counted], fmt="o", color=BLUE, capsize=2)
    for x, y, n in zip(stated, true, score["stated_count"].values, strict=True):
        if n:
            ax.annotate(f"{n}", (x, y), (4, -9), textcoords="offset points", color=GREY)
    ax.set(xlabel="stated probability", ylabel="share that was there", ylim=(-0.05, 1.05))
    return figure


@styled
def draw_buried_case(residual: xr.Dataset) -> Figure:
    """Draw a joint's residuals before and after the repair.

    Each point is a mean over trials, in units of its own standard deviation under noise alone.

    Parameters
    ----------
    residual
        mean_residual (model, joint, window), window [s].
    """
    figure = new_figure(get_source(residual), height=2.6)
    axes = figure.subplots(1, residual.sizes["joint"], sharey=True, squeeze=False)[0]
    for ax, joint in zip(axes, residual["joint"].values, strict=True):
        for model, colour in (("base", RED), ("final", BLUE)):
            mean = residual["mean_residual"].sel(joint=joint, model=model).values
            ax.plot(residual["window"].values, mean, "o-", color=colour, markersize=3)
        ax.axhspan(-2, 2, color=PALE, alpha=0.5, linewidth=0)
        ax.set(title=f"joint {joint}", xlabel="time [s]")
    axes[0].set_ylabel("mean residual / its sd")
    axes[0].legend(labels=["base model", "repaired model"])
    return figure
