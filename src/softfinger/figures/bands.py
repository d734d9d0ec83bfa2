"""Predictive bands of the joint angle beside recordings."""

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from softfinger.figures.style import (
    ESTIMATE_COLOURS,
    ESTIMATE_LABELS,
    RECORDED,
    get_source,
    label_motion,
    new_figure,
    styled,
)

MOST_PROTOCOLS = 12
COLUMNS = 3


@styled
def draw_bands(bands: xr.Dataset, end: float | None = None) -> Figure:
    """Draw predictive bands of the model and the recordings.

    Filled: the posterior predictive interval of a new recording between the outermost quantiles,
    and its median. Dashed: the same limits of the two-stage estimate. Black: the recordings' median
    and limits.

    Parameters
    ----------
    bands
        predicted_quantile (estimate, protocol, joint, time, quantile) and recorded_quantile of
        the artifact `bands`, with protocol_trials (protocol); its 12 protocols of most trials are
        shown.
    end
        Show the time up to here [s]; None shows all.
    """
    shown = choose_protocols(bands)
    joints = bands["joint"]
    panels = [(protocol, joint) for protocol in shown for joint in joints.values]
    columns = joints.size if 1 < joints.size <= 4 else min(COLUMNS, len(panels))
    rows = -(-len(panels) // columns)
    figure = new_figure(get_source(bands), height=0.7 + 1.55 * rows)
    axes = figure.subplots(rows, columns, squeeze=False, sharex=True)
    inside = bands if end is None else bands.sel(time=slice(None, end))
    for ax, (protocol, joint) in zip(axes.flat, panels, strict=False):
        draw_panel(ax, inside.sel(protocol=protocol, joint=joint))
        ax.set_title(title_panel(bands, protocol, joint))
    for ax in axes.flat[len(panels) :]:
        ax.set_axis_off()
    figure.supxlabel("time [s]", size=7)
    figure.supylabel(label_motion(bands), size=7)
    figure.legend(*axes[0, 0].get_legend_handles_labels(), loc="outside upper left", ncols=4)
    return figure


def choose_protocols(bands: xr.Dataset) -> np.ndarray:
    """Protocols of most trials, in the artifact's order."""
    places = np.sort(np.argsort(-bands["protocol_trials"].values, kind="stable")[:MOST_PROTOCOLS])
    return bands["protocol"].values[places]


def title_panel(bands: xr.Dataset, protocol: str, joint: int) -> str:
    """Name a panel by what distinguishes it."""
    names = [f"joint {joint}"] if bands["joint"].size > 1 else []
    names += [str(protocol)] if bands["protocol"].size > 1 else []
    return ", ".join(names) or f"joint {joint}"


def draw_panel(ax: Axes, bands: xr.Dataset) -> None:
    """Draw one protocol and joint (time)."""
    time = bands["time"].values
    middle = {"quantile": 0.5, "method": "nearest"}
    for estimate in bands["estimate"].values:
        colour, label = ESTIMATE_COLOURS[str(estimate)], ESTIMATE_LABELS[str(estimate)]
        quantiles = bands["predicted_quantile"].sel(estimate=estimate)
        low, high = quantiles.isel(quantile=0).values, quantiles.isel(quantile=-1).values
        if not np.isfinite(low).any():
            continue
        if estimate == "posterior":
            ax.fill_between(time, low, high, color=colour, alpha=0.22, lw=0, label=f"_{label}")
            ax.plot(time, quantiles.sel(**middle).values, color=colour, label=label)
        else:
            ax.plot(time, low, color=colour, linestyle="--", linewidth=0.8, label=label)
            ax.plot(time, high, color=colour, ls="--", linewidth=0.8, label=f"_{label}, upper")
    recorded = bands["recorded_quantile"]
    ax.plot(time, recorded.sel(**middle).values, color=RECORDED, linewidth=0.8, label="recorded")
    for place in (0, -1):
        limit = recorded.isel(quantile=place).values
        ax.plot(time, limit, color=RECORDED, lw=0.7, ls=":", label="_recorded, limit")
