"""Residuals since the load changed; their spectrum."""

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import LogLocator, NullFormatter

from softfinger.figures.style import (
    BLUE,
    GREY,
    PALE,
    RED,
    get_motion_unit,
    get_source,
    new_figure,
    styled,
)
from softfinger.units import label_thousandth

EARLY = 1.0
"""End of the early look [s]."""
CHANGE_STYLES = {"rise": (BLUE, "after the load rose"), "fall": (RED, "after the load fell")}


@styled
def draw_residuals(residuals: xr.Dataset) -> Figure:
    """Draw the mean residual and the residual's spectrum.

    Left: recording minus model, the mean over trials, all of it and the first second; the band is
    what chance leaves of it, two standard errors. Whatever leaves the band is motion that
    most trials share and the model does not have. Right: the residual's power times frequency, so
    that equal areas are equal variance; a narrow peak is a ring.

    Parameters
    ----------
    residuals
        `mean_residual`, `residual_se` (change, joint, since_change) [rad];
        `residual_power` (change, joint, frequency) [rad2], frequency times power spectral density;
        `peak_frequency` (change, joint) [Hz], NaN where there is no narrow peak.
    """
    joints, small = residuals["joint"], label_thousandth(get_motion_unit(residuals))
    figure = new_figure(get_source(residuals), height=0.5 + 1.6 * joints.size)
    axes = figure.subplots(joints.size, 3, squeeze=False, sharex="col", width_ratios=[1.3, 1, 1])
    for (whole, early, right), joint in zip(axes, joints.values, strict=True):
        here = residuals.sel(joint=joint)
        draw_mean_residual(whole, here)
        draw_mean_residual(early, here.sel(since_change=slice(None, EARLY)))
        draw_spectrum(right, here)
        whole.set(ylabel=f"recording − model [{small}]", title=f"joint {joint}")
        early.set(title="the first second")
        right.set(ylabel=f"frequency × power [({small})²]", title="its spectrum")
    for ax in axes[-1, :2]:
        ax.set_xlabel("time since the load changed [s]")
    axes[-1, 2].set_xlabel("frequency [Hz]")
    figure.legend(*axes[0, 0].get_legend_handles_labels(), loc="outside upper left", ncols=2)
    return figure


def draw_mean_residual(ax: Axes, residuals: xr.Dataset) -> None:
    """Draw one joint's mean residual [mrad] and chance."""
    time = residuals["since_change"].values
    ax.axhline(0, color=GREY, linewidth=0.6, label="_")
    for change in residuals["change"].values:
        colour, label = CHANGE_STYLES[str(change)]
        here = residuals.sel(change=change)
        chance = 2e3 * here["residual_se"].values
        ax.fill_between(time, -chance, chance, color=PALE, alpha=0.6, lw=0, label="_chance")
        ax.plot(time, 1e3 * here["mean_residual"].values, color=colour, label=label)


def draw_spectrum(ax: Axes, residuals: xr.Dataset) -> None:
    """Draw one joint's spectrum and name its ring."""
    frequency = residuals["frequency"].values
    for change in residuals["change"].values:
        colour, label = CHANGE_STYLES[str(change)]
        here = residuals.sel(change=change)
        power = 1e6 * here["residual_power"].values
        ax.plot(frequency, power, color=colour, label=f"_{label}")
        peak = float(here["peak_frequency"])
        if np.isfinite(peak):
            height = power[np.abs(frequency - peak).argmin()]
            ax.annotate(
                f"{peak:.1f} Hz", (peak, height), (4, 2), textcoords="offset points", color=colour
            )
    ax.set_xscale("log")
    ax.xaxis.set_major_locator(LogLocator(subs=(1, 3)))
    ax.xaxis.set_major_formatter("{x:g}")
    ax.xaxis.set_minor_formatter(NullFormatter())
    ax.margins(x=0.02, y=0.15)
    ax.set_ylim(bottom=0)
