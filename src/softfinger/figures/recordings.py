"""Every trial's joint angles and loads over time."""

import matplotlib as mpl
import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.collections import LineCollection
from matplotlib.colors import ListedColormap, Normalize
from matplotlib.figure import Figure

from softfinger.figures.style import (
    get_source,
    label_load_unit,
    label_motion,
    new_figure,
    styled,
)

LOAD_COLOURS = ListedColormap(mpl.colormaps["viridis"](np.linspace(0, 0.9, 256)))
"""Viridis without its palest tenth, which is too faint on paper."""
JUMP = 4
"""Bit of `angle_flag` of a masked outlier."""


@styled
def draw_recordings(angles: xr.Dataset) -> Figure:
    """Draw every trial's joint angle over time.

    Lines are coloured by the trial's largest load and rasterised, so that a hundred trials stay
    small in a vector file. Missing and masked frames leave gaps.
    """
    joints = angles["joint"]
    seen = angles["joint_angle"].where((angles["angle_flag"] & JUMP) == 0)
    rows = joints.size + 1
    figure = new_figure(get_source(angles), height=0.6 + 1.15 * rows)
    axes = figure.subplots(
        rows, 1, sharex=True, squeeze=False, height_ratios=[1.0] * joints.size + [0.55]
    )[:, 0]
    colours = _LoadColours(angles)
    for ax, joint in zip(axes[:-1], joints.values, strict=True):
        draw_trials(ax, angles, seen.sel(joint=joint), colours.of_trials)
        ax.set(ylabel=label_motion(angles), title=f"joint {joint}")
    draw_loads(axes[-1], angles, colours.of_trials)
    axes[-1].set(ylabel=f"load [{label_load_unit(angles)}]", xlabel="time [s]")
    if colours.vary:
        figure.colorbar(
            colours.scale, ax=axes, label=f"largest load [{label_load_unit(angles)}]", aspect=45
        )
    return figure


class _LoadColours:
    """A trial's colour by its load, if they differ."""

    def __init__(self, angles: xr.Dataset) -> None:
        load = angles["load_torque"].values
        peak = np.take_along_axis(load, np.abs(load).argmax(axis=1)[:, None], axis=1)[:, 0]
        self.vary = bool(np.ptp(peak) > 1e-9 * np.abs(peak).max())
        self.scale = ScalarMappable(Normalize(peak.min(), peak.max()), LOAD_COLOURS)
        self.of_trials = self.scale.to_rgba(peak) if self.vary else LOAD_COLOURS([0.3] * peak.size)


def draw_trials(ax: Axes, angles: xr.Dataset, series: xr.DataArray, colours: np.ndarray) -> None:
    """Draw one line of `series` (trial, frame) each."""
    pairs = zip(angles["time"].values, series.transpose("trial", "frame").values, strict=True)
    lines = [np.column_stack(pair) for pair in pairs]
    alpha = float(np.clip(6 / max(len(lines), 1), 0.25, 0.9))
    ax.add_collection(
        LineCollection(
            lines, colors=colours, linewidths=0.6, alpha=alpha, rasterized=True, label="_trials"
        )
    )
    ax.autoscale_view()


def draw_loads(ax: Axes, angles: xr.Dataset, colours: np.ndarray) -> None:
    """Draw every trial's load over time.

    It is 0 before the first knot, and keeps its last value after the last knot.
    """
    end = float(angles["time"].max())
    lines = []
    for time, load in zip(angles["load_time"].values, angles["load_torque"].values, strict=True):
        start = min(0.0, time[0])
        padded = np.concatenate([[start, time[0]], time, [max(end, time[-1])]])
        lines.append(np.column_stack([padded, np.concatenate([[0.0, 0.0], load, load[-1:]])]))
    style = {"colors": colours, "linewidths": 0.8, "rasterized": True, "label": "_load"}
    ax.add_collection(LineCollection(lines, **style))
    ax.autoscale_view()
