"""Agreement of chains and effective number of draws."""

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from softfinger.figures.style import (
    BLUE,
    GREEN,
    GREY,
    ORANGE,
    PINK,
    RED,
    get_source,
    label_log_axis,
    new_figure,
    styled,
)

CHAIN_COLOURS = (BLUE, ORANGE, GREEN, PINK)


@styled
def draw_sampling(sampling: xr.Dataset, worst: xr.Dataset) -> Figure:
    """Draw R-hat and effective draws of every quantity.

    Parameters
    ----------
    worst
        worst_draws, running_mean (chain, draw) of the quantity of the largest R-hat [sd].
    """
    figure = new_figure(get_source(sampling), height=2.1)
    left, middle, right = figure.subplots(1, 3, width_ratios=[1, 1, 1.3])
    draw_sorted(left, sampling["r_hat"].values, BLUE)
    draw_limit(left, sampling.attrs["r_hat_max"], 0.02)
    left.set(xlabel="quantities, sorted", ylabel="R-hat", title="chains agree")
    draw_sorted(middle, sampling["ess_bulk"].values, BLUE, "bulk")
    draw_sorted(middle, sampling["ess_tail"].values, ORANGE, "tail")
    draw_limit(middle, sampling.attrs["ess_min"], 0.6)
    middle.set_yscale("log")
    label_log_axis(middle.yaxis)
    middle.set(xlabel="quantities, sorted", ylabel="effective draws", title="draws suffice")
    middle.legend()
    draw_trace(right, worst)
    return figure


def draw_sorted(ax: Axes, values: np.ndarray, colour: str, label: str = "_R-hat") -> None:
    """Draw values in ascending order."""
    style = {"marker": ".", "ms": 3, "ls": "none", "color": colour, "rasterized": True}
    ax.plot(np.arange(1, values.size + 1), np.sort(values), label=label, **style)


def draw_limit(ax: Axes, limit: float, place: float) -> None:
    """Draw a limit and its name.

    The name is placed at a share of the axis.
    """
    ax.axhline(limit, color=RED, linewidth=0.8, linestyle="--", label="_limit")
    ax.annotate(
        f"limit {limit:g}",
        (place, limit),
        (0, 2),
        ("axes fraction", "data"),
        textcoords="offset points",
        color=RED,
        size=7,
    )


def draw_trace(ax: Axes, worst: xr.Dataset) -> None:
    """Draw the chains of one quantity, running means thick."""
    for chain in range(worst.sizes["chain"]):
        colour = CHAIN_COLOURS[chain % len(CHAIN_COLOURS)]
        here = worst.isel(chain=chain)
        draws, running = here["worst_draws"].values, here["running_mean"].values
        ax.plot(
            draws,
            color=colour,
            linewidth=0.4,
            alpha=0.6,
            rasterized=True,
            label=f"_chain {chain + 1}",
        )
        ax.plot(running, color=colour, linewidth=1.4, label=f"_chain {chain + 1}, running mean")
    ax.axhline(0, color=GREY, linewidth=0.5, label="_")
    ax.set(xlabel="draw", ylabel="standard deviations", title="the least agreed quantity")
