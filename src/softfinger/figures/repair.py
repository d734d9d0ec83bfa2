"""Recordings beside the base and the repaired model."""

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from softfinger.figures.style import (
    BLUE,
    PALE,
    RECORDED,
    RED,
    build_joint_axes,
    get_motion_unit,
    get_source,
    label_motion,
    measure_joint_rows,
    new_figure,
    styled,
)
from softfinger.units import label_thousandth

WIDEST_BAND = 0.8
"""How far a band is drawn beyond the recordings, over their range."""
MODEL_STYLES = {"base": (RED, "--", "base model"), "final": (BLUE, "-", "repaired model")}


@styled
def draw_repair(repair: xr.Dataset, trial: str, like: NDArray[np.bool_]) -> Figure:
    """Draw recordings with the band of each model.

    Columns are joints. Top: recordings under the load of `trial`, and the band of a new trial
    that the others predict; for a single trial each model at its own mode. Below: what each model
    leaves of `trial` at its own mode; grey is twice the noise of a bin.

    Parameters
    ----------
    repair
        The artifact `repair`.
    trial
        The one whose band and rest are drawn.
    like : (trial,)
        The trials that are drawn.
    """
    joints = repair["joint"].values
    figure = new_figure(
        get_source(repair), height=0.5 + 1.35 * measure_joint_rows(joints.size, n_row=2)
    )
    axes = build_joint_axes(figure, joints.size, n_row=2)
    for column, joint in zip(axes.T, joints, strict=True):
        here = repair.sel(joint=joint)
        draw_recorded(column[0], here.sel(trial=like))
        for model in repair["model"].values:
            draw_model(column[0], here.sel(trial=trial, model=model))
        limit_to_recorded(column[0], here.sel(trial=like)["recorded_angle"].values)
        draw_leftover(column[1], here.sel(trial=trial))
        column[0].set(title=f"joint {joint}")
    for ax in axes[-1] if joints.size <= 4 else axes.T[-1]:
        ax.set(xlabel="time [s]")
    axes[0, 0].set_ylabel(label_motion(repair))
    axes[1, 0].set_ylabel(f"left over [{label_thousandth(get_motion_unit(repair))}]")
    figure.legend(*axes[0, 0].get_legend_handles_labels(), loc="outside upper left", ncols=3)
    return figure


def draw_recorded(ax: Axes, repair: xr.Dataset) -> None:
    """Draw every recording (trial, bin) of a joint."""
    gap = {"pad_width": ((0, 0), (0, 1)), "constant_values": np.nan}
    time, angle = (
        np.pad(repair[name].transpose("trial", "bin").values, **gap).ravel()
        for name in ("time", "recorded_angle")
    )
    ax.plot(time, angle, color=RECORDED, lw=0.4, alpha=0.7, label="recordings")


def limit_to_recorded(ax: Axes, recorded: NDArray[np.float64]) -> None:
    """Keep a wide band from flattening the recordings."""
    low, high = np.nanmin(recorded), np.nanmax(recorded)
    reach = WIDEST_BAND * (high - low)
    bottom, top = ax.get_ylim()
    ax.set_ylim(max(bottom, low - reach), min(top, high + reach))


def draw_model(ax: Axes, repair: xr.Dataset) -> None:
    """Draw one model's band (quantile, bin), or its fit."""
    colour, line, label = MODEL_STYLES[str(repair["model"].item())]
    time = repair["time"].values
    low, middle, high = repair["predicted_quantile"].transpose("quantile", "bin").values
    if not np.isfinite(middle).any():
        ax.plot(time, repair["fitted_angle"].values, line, color=colour, lw=0.9, label=label)
        return
    ax.plot(time, middle, line, color=colour, lw=1.0, label=label)
    if repair["model"].item() == "base":
        for edge in (low, high):
            ax.plot(time, edge, line, color=colour, lw=0.8, label=f"_{label}, limit of the band")
    else:
        ax.fill_between(time, low, high, color=colour, alpha=0.22, lw=0, label=f"_{label}, band")


def draw_leftover(ax: Axes, repair: xr.Dataset) -> None:
    """Draw all models' residuals of a trial's joint [mrad]."""
    time, noise = repair["time"].values, 2e3 * repair["bin_noise_sd"].values
    ax.fill_between(time, -noise, noise, color=PALE, alpha=0.6, lw=0, label="twice the noise")
    for model in repair["model"].values:
        colour, line, label = MODEL_STYLES[str(model)]
        left = repair["recorded_angle"] - repair["fitted_angle"].sel(model=model)
        ax.plot(time, 1e3 * left.values, line, color=colour, lw=0.8, label=label)
