"""Figures of left-out physics."""

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.colors import LogNorm
from matplotlib.figure import Figure

from softfinger.figures.style import (
    BLUE,
    DOUBLE_COLUMN,
    GREY,
    PALE,
    RECORDED,
    RED,
    SKY,
    get_motion_unit,
    get_source,
    label_log_axis,
    label_motion,
    label_thousandth,
    new_figure,
    styled,
)

MODEL_STYLES = {"base": (RED, "--", "base model"), "final": (BLUE, "-", "repaired model")}
MOST_ROWS = 20
SMALLEST_Q = 1e-6


@styled
def draw_repair(repair: xr.Dataset, misfit: xr.Dataset, trial: str) -> Figure:
    """Draw one trial with its models.

    Columns are joints. Top: the recording and its models at the trial's own mode. Middle: what
    each leaves of that trial; grey is twice the noise of a bin. Bottom: mean square of what each
    leaves of all trials over that of the noise, against the time since the load changed; 1 is
    noise alone.

    Parameters
    ----------
    misfit
        mean_square (model, joint, since_change).
    """
    here = repair.sel(trial=trial)
    joints = repair["joint"].values
    figure = new_figure(get_source(repair), height=4.4)
    axes = figure.subplots(3, joints.size, squeeze=False, height_ratios=[1.3, 1, 1])
    for column, joint in zip(axes.T, joints, strict=True):
        draw_fit(column[0], here.sel(joint=joint))
        draw_leftover(column[1], here.sel(joint=joint))
        draw_misfit(column[2], misfit.sel(joint=joint))
        column[0].set(title=f"joint {joint}")
        column[1].set(xlabel="time [s]")
        column[2].set(xlabel="time since the load changed [s]")
    for row in axes[:2]:
        for ax in row[1:]:
            ax.sharex(row[0])
    axes[0, 0].set_ylabel(label_motion(repair))
    axes[1, 0].set_ylabel(f"left over [{label_thousandth(get_motion_unit(repair))}]")
    axes[2, 0].set_ylabel("squared residual\nover noise [1]")
    figure.legend(*axes[0, 0].get_legend_handles_labels(), loc="outside upper left", ncols=3)
    axes[0, 0].set_title(f"joint {joints[0]} ({trial})")
    return figure


def draw_fit(ax: Axes, repair: xr.Dataset) -> None:
    """Draw one trial and joint with both models (bin)."""
    time = repair["time"].values
    ax.plot(time, repair["recorded_angle"].values, ".", color=RECORDED, ms=1.6, label="recording")
    for model in repair["model"].values:
        colour, line, label = MODEL_STYLES[str(model)]
        ax.plot(time, repair["fitted_angle"].sel(model=model).values, line, color=colour,
                lw=0.9, label=label)  # fmt: skip


def draw_leftover(ax: Axes, repair: xr.Dataset) -> None:
    """Draw both models' residuals of a trial's joint [mrad]."""
    time, noise = repair["time"].values, 2e3 * repair["bin_noise_sd"].values
    ax.fill_between(time, -noise, noise, color=PALE, alpha=0.6, linewidth=0)
    for model in repair["model"].values:
        colour, line, _ = MODEL_STYLES[str(model)]
        left = repair["recorded_angle"] - repair["fitted_angle"].sel(model=model)
        ax.plot(time, 1e3 * left.values, line, color=colour, lw=0.8)


def draw_misfit(ax: Axes, misfit: xr.Dataset) -> None:
    """Draw squared residuals over noise after load changes."""
    ax.axhline(1.0, color=GREY, lw=0.7)
    for model in misfit["model"].values:
        colour, line, _ = MODEL_STYLES[str(model)]
        mean = misfit["mean_square"].sel(model=model).values
        ax.plot(misfit["since_change"].values, mean, line, color=colour, marker="o", ms=2.5)
    ax.set(xscale="log", yscale="log")
    label_log_axis(ax.xaxis)
    label_log_axis(ax.yaxis)


@styled
def draw_ranking(ranking: xr.Dataset, evidence: xr.Dataset) -> Figure:
    """Draw every effect's gain over the base model.

    Parameters
    ----------
    ranking
        best_gain (effect) and needed_gain () [nats].
    evidence
        needed (effect), chance_range (end) [nats].
    """
    order = np.argsort(-ranking["best_gain"].values, kind="stable")[:MOST_ROWS]
    shown = ranking.isel(effect=order[::-1])
    figure = new_figure(get_source(ranking), 0.7 + 0.17 * max(order.size, 3), DOUBLE_COLUMN * 0.62)
    ax = figure.subplots()
    rows = np.arange(order.size)
    gain = shown["best_gain"].values
    included = evidence["needed"].sel(effect=shown["effect"]).values
    ax.axvspan(*evidence["chance_range"].values, color=PALE, lw=0,
               label="chance, over the whole catalogue")  # fmt: skip
    ax.axvline(float(ranking["needed_gain"]), color=GREY, ls=":", label="believed from here")
    ax.hlines(rows, 0.0, gain, color=GREY, lw=0.6)
    ax.plot(gain[~included], rows[~included], "o", mfc="white", color=GREY, label="not needed")
    ax.plot(gain[included], rows[included], "o", color=BLUE, label="needed (probability > ½)")
    ax.set_yticks(rows, [str(name).replace("_", " ") for name in shown["effect"].values])
    ax.set_xscale("symlog", linthresh=1.0)
    ax.margins(x=0.06)
    ax.set_xlabel("log evidence over the base model, alone [nats]")
    ax.grid(axis="y", visible=False)
    figure.legend(*ax.get_legend_handles_labels(), loc="outside lower center", ncols=2)
    return figure


@styled
def draw_location(location: xr.Dataset) -> Figure:
    """Draw where the base and the final model miss.

    Each row is a joint; colour is the rate at which a cell counts as missed, 1e-6 or less darkest;
    empty cells contain too few angles.

    Parameters
    ----------
    location
        q_value (model, joint, phase, window).
    """
    for dim in ("phase", "window"):
        location = location.dropna(dim, how="all", subset=["q_value"])
    models = [str(name) for name in location["model"].values]
    joints = location["joint"].values
    figure = new_figure(get_source(location), height=max(1.9, 0.8 + 0.75 * joints.size))
    axes = figure.subplots(joints.size, len(models), squeeze=False, sharex=True, sharey=True)
    scale = LogNorm(SMALLEST_Q, 1.0)
    for row, joint in zip(axes, joints, strict=True):
        for ax, model in zip(row, models, strict=True):
            value = location["q_value"].sel(joint=joint, model=model).values
            drawn = ax.pcolormesh(np.maximum(value, SMALLEST_Q), norm=scale, cmap="cividis")
            ax.set_title(f"{MODEL_STYLES[model][2]}, joint {joint}")
            ax.set_yticks(np.arange(value.shape[0]) + 0.5, location["phase"].values.tolist())
            ax.grid(visible=False)
            ax.spines[["left", "bottom"]].set_visible(False)
    edges = [f"{w:g}" for w in location["window"].values]
    for ax in axes[-1]:
        ax.set_xticks(np.arange(len(edges)), edges)
        ax.set_xlabel("time since the load changed, from [s]")
    figure.colorbar(drawn, ax=axes, label="false-discovery rate", extend="min", aspect=30)
    return figure


@styled
def draw_masking(masking: xr.Dataset) -> Figure:
    """Draw what is left of every effect's signal.

    Parameters
    ----------
    masking
        share_left, expected_gain (effect), likeness (effect, other_effect).
    """
    order = np.argsort(-masking["share_left"].values, kind="stable")
    shown = masking.isel(effect=order, other_effect=order)
    names = [str(name).replace("_", " ") for name in shown["effect"].values]
    figure = new_figure(get_source(masking), height=0.9 + 0.19 * max(len(names), 4))
    left, right = figure.subplots(1, 2, width_ratios=[1, 1.25], sharey=True)
    rows = np.arange(len(names))
    left.barh(rows, 100 * shown["share_left"].values, color=SKY, height=0.7)
    for row, gain in zip(rows, shown["expected_gain"].values, strict=True):
        left.annotate(write_gain(gain), (1, row), (34, 0), xycoords=("axes fraction", "data"),
                      textcoords="offset points", ha="right", va="center", fontsize=6)  # fmt: skip
    left.set_yticks(rows, names)
    left.set(xlabel="signal left after refitting [%]", xlim=(0, 100))
    left.set_title("signal left; right: gain to expect [nats]")
    left.grid(axis="y", visible=False)
    drawn = right.imshow(np.abs(shown["likeness"].values), cmap="cividis", vmin=0, vmax=1,
                         aspect="auto")  # fmt: skip
    right.set_xticks(rows, names, rotation=90)
    right.set_title("likeness of what is left, |cosine|")
    right.grid(visible=False)
    figure.colorbar(drawn, ax=right)
    return figure


def write_gain(gain: float) -> str:
    """Write a log evidence in few characters.

    >>> write_gain(0.0102), write_gain(546.3), write_gain(6130.0), write_gain(4e7)
    ('0.01', '546', '6130', '> 10 000')
    """
    if gain >= 1e4:
        return "> 10 000"
    return f"{gain:.0f}" if gain >= 100 else f"{gain:.2g}"
