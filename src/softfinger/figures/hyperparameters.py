"""Forest plot: where and how wide populations are."""

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from softfinger.figures.style import (
    BLACK,
    PARAMETER_LABELS,
    POSTERIOR,
    TWO_STAGE,
    get_motion_unit,
    get_source,
    new_figure,
    styled,
)

LOCATION_LABELS = {"mu": "centre", "sigma": "spread"}
MARKERS = {
    "two_stage": (TWO_STAGE, "x", "two-stage"),
    "paper": (BLACK, "s", "the paper's table"),
}


@styled
def draw_hyperparameters(hyperparameters: xr.Dataset) -> Figure:
    """Draw intervals of the population's centre and spread.

    Thin line: interval of the stated probability; thick line: 50 %; dot: posterior median. Beside
    it whatever else is known: the two-stage estimate, the paper's table.

    Parameters
    ----------
    hyperparameters
        `quantile_value` (quantile, statistic, parameter, joint), quantile in ascending order
        low, 0.25, 0.5, 0.75, high; statistic `mu`, `sigma`; of the logarithm for all parameters
        but q_ini. Optional `rival_value` (rival, statistic, parameter, joint) of `two_stage` and
        `paper`.
    """
    parameters, joints = hyperparameters["parameter"].values, hyperparameters["joint"].values
    height = 0.9 + 2 * (0.45 + 0.22 * joints.size)
    figure = new_figure(get_source(hyperparameters), height=height)
    axes = figure.subplots(2, parameters.size, squeeze=False, sharey=True)
    for row, statistic in zip(axes, ("mu", "sigma"), strict=True):
        for ax, parameter in zip(row, parameters, strict=True):
            draw_forest(ax, hyperparameters.sel(statistic=statistic, parameter=parameter))
            unit = get_motion_unit(hyperparameters)
            ax.set_xlabel(label_axis(statistic, str(parameter), unit))
            ax.xaxis.set_major_locator(MaxNLocator(4))
    axes[0, 0].set_yticks(range(joints.size), [f"joint {joint}" for joint in joints])
    axes[0, 0].set_ylim(joints.size - 0.4, -0.6)
    figure.legend(*axes[0, 0].get_legend_handles_labels(), loc="outside upper left", ncols=4)
    return figure


def label_axis(statistic: str, parameter: str, motion_unit: str) -> str:
    """Label the axis of one hyperparameter with its scale."""
    name = PARAMETER_LABELS[parameter]
    if parameter == "q_ini":
        return f"{LOCATION_LABELS[statistic]} of {name} [{motion_unit}]"
    return f"{LOCATION_LABELS[statistic]} of ln {name}"


def draw_forest(ax: Axes, hyperparameters: xr.Dataset) -> None:
    """Draw one hyperparameter's intervals, one row per joint."""
    low, lower, middle, upper, high = hyperparameters["quantile_value"].transpose("quantile", ...)
    rows = np.arange(middle.size)
    ax.hlines(rows, low, high, color=POSTERIOR, linewidth=0.9, label="_posterior, wide")
    ax.hlines(rows, lower, upper, color=POSTERIOR, linewidth=2.6, label="_posterior, 50 %")
    ax.plot(middle, rows, "o", color=POSTERIOR, mec="white", mew=0.5, ms=4.5, label="posterior")
    for name in hyperparameters["rival"].values if "rival" in hyperparameters.dims else ():
        colour, marker, label = MARKERS[str(name)]
        style = {"color": colour, "marker": marker, "ls": "none", "ms": 4, "mfc": "none"}
        value = hyperparameters["rival_value"].sel(rival=name).values
        ax.plot(value, rows + 0.22, label=label, **style)
    ax.grid(visible=False, axis="y")
