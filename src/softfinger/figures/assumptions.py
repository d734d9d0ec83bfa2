"""What the paper's assumptions leave out, and where."""

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from softfinger.figures.style import (
    BLUE,
    GREY,
    PARAMETER_LABELS,
    PARAMETER_STYLES,
    RED,
    get_source,
    new_figure,
    styled,
)

CAUSES = {"inertia": ("inertia", BLUE), "moment_arm": ("moment arm grows", RED)}
MATTERS_MRAD = 1.0
EARLIEST = 1e-4
"""Start of the time axis [s]."""


@styled
def draw_assumptions(assumptions: xr.Dataset, changes: xr.Dataset) -> Figure:
    """Draw the gaps over time and the torque's growth.

    Parameters
    ----------
    changes
        Its group in the artifact `summary`: fitted_change (quantile, joint, parameter), three
        ascending quantiles over the fingers.
    """
    figure = new_figure(get_source(assumptions), height=4.2)
    above, below = figure.subfigures(2, 1)
    joints = assumptions["joint"]
    axes = above.subplots(1, joints.size, sharex=True, sharey=True, squeeze=False)[0]
    for ax, joint in zip(axes, joints.values, strict=True):
        ax.set_title(f"joint {joint}")
        draw_gaps(ax, assumptions.sel(joint=joint))
    axes[0].set_ylabel("gap [mrad]")
    above.legend(*axes[0].get_legend_handles_labels(), loc="outside upper left", ncols=5)
    left, right = below.subplots(1, 2, width_ratios=(1, 2))
    draw_growth(left, assumptions)
    draw_changes(right, changes)
    return figure


def draw_gaps(ax: Axes, assumptions: xr.Dataset) -> None:
    """Draw one joint's gaps by cause over time."""
    later = assumptions.sel(time=slice(EARLIEST, None))
    for cause, (words, colour) in CAUSES.items():
        for name, line, kind in (("gap_largest_at", "-", "largest"), ("gap_rms_at", ":", "rms")):
            gap = 1e3 * later[name].sel(cause=cause)
            ax.plot(later["time"], gap, line, color=colour, label=f"{words}, {kind}")
    ax.axhline(MATTERS_MRAD, color=GREY, linewidth=0.5, label="_")
    ax.set(xscale="log", yscale="log", xlabel="time [s]", ylim=(1e-3, None))


def draw_growth(ax: Axes, assumptions: xr.Dataset) -> None:
    """Draw the torque's growth, with the fingers' ends."""
    ax.plot(
        assumptions["angle"], 100 * assumptions["arm_growth"], color=RED, zorder=3, label="_growth"
    )
    reached = (assumptions[name].values.ravel() for name in ("angle_reached", "torque_growth"))
    angle, growth = reached
    ax.plot(angle, 100 * growth, "|", color=GREY, markersize=5, label="reached in 30 s")
    ax.set(xlabel="joint angle [rad]", ylabel="growth of the torque [%]", xlim=(0, None))
    ax.legend(loc="lower right")


def draw_changes(ax: Axes, changes: xr.Dataset) -> None:
    """Draw median and 90 % range of errors."""
    ticks = []
    for place, parameter in enumerate(("k_v", "c_v", "c_p")):
        change = 100 * changes["fitted_change"].sel(parameter=parameter)
        low, middle, high = change.transpose("quantile", "joint").values
        at = place * (change["joint"].size + 1) + np.arange(change["joint"].size)
        colour = PARAMETER_STYLES[parameter][0]
        ax.vlines(at, low, high, color=colour, label=f"_{parameter}")
        ax.plot(at, middle, "o", color=colour, markersize=3, label=f"_{parameter}")
        ticks += [
            (x, f"{PARAMETER_LABELS[parameter]}, {j}")
            for x, j in zip(at, change["joint"].values, strict=True)
        ]
    ax.axhline(0.0, color=GREY, linewidth=0.5, label="_")
    ax.set_xticks(*zip(*ticks, strict=True))
    ax.set(xlabel="parameter, joint", ylabel="fitted − true [%]")
