"""From the parameters' spread to the motion's."""

import matplotlib as mpl
import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from softfinger.figures.style import (
    PARAMETER_LABELS,
    PARAMETER_STYLES,
    build_joint_axes,
    get_source,
    label_motion,
    measure_joint_rows,
    new_figure,
    styled,
)

EARLY = 1.0
"""End of the second row of the Sobol figure [s]."""


@styled
def draw_sobol(sobol: xr.Dataset) -> Figure:
    """Draw first-order Sobol indices over time.

    Lines: the share of the angle's variance that each parameter causes alone. Bands: the interval
    that the posterior leaves, where the artifact has one. Thin lines: the total effect.

    Parameters
    ----------
    sobol
        `first_order`, `total` ([quantile,] joint, time, parameter).
    """
    joints = sobol["joint"]
    figure = new_figure(get_source(sobol), height=0.6 + 1.6 * measure_joint_rows(joints.size, 2))
    axes = build_joint_axes(figure, joints.size, 2, sharex=False, sharey=True)
    for column, joint in zip(axes.T, joints.values, strict=True):
        column[0].set_title(f"joint {joint}")
        for ax, end in zip(column, (None, EARLY), strict=True):
            draw_indices(ax, sobol.sel(joint=joint, time=slice(None, end)))
            ax.set_xlabel("time [s]")
    axes[0, 0].set_ylim(-0.02, 1.02)
    figure.supylabel("share of the variance", size=7)
    figure.legend(*axes[0, 0].get_legend_handles_labels(), loc="outside upper left", ncols=4)
    return figure


def draw_indices(ax: Axes, sobol: xr.Dataset) -> None:
    """Draw the indices of one joint over time."""
    time = sobol["time"].values
    for parameter in sobol["parameter"].values:
        colour, line = PARAMETER_STYLES[str(parameter)]
        label = PARAMETER_LABELS[str(parameter)]
        first, total = (sobol[name].sel(parameter=parameter) for name in ("first_order", "total"))
        if "quantile" in first.dims:
            low, high = (first.isel(quantile=place) for place in (0, -1))
            ax.fill_between(time, low, high, color=colour, alpha=0.2, lw=0, label=f"_{label}")
        ax.plot(time, take_middle(first), color=colour, linestyle=line, label=label)
        ax.plot(time, take_middle(total), color=colour, linewidth=0.5, label=f"_{label}, total")


@styled
def draw_shapley(shapley: xr.Dataset) -> Figure:
    """Draw Shapley effects of correlated parameters over time.

    Parameters
    ----------
    shapley
        `shapley_quantile` (joint, time, parameter, quantile).
    """
    joints, effects = shapley["joint"], shapley["shapley_quantile"]
    figure = new_figure(get_source(shapley), height=0.6 + 1.6 * measure_joint_rows(joints.size, 1))
    axes = build_joint_axes(figure, joints.size, 1, sharex=True, sharey=True)
    for ax, joint in zip(axes[0], joints.values, strict=True):
        ax.set(title=f"joint {joint}", xlabel="time [s]")
        for parameter in effects["parameter"].values:
            colour, line = PARAMETER_STYLES[str(parameter)]
            one = effects.sel(joint=joint, parameter=parameter)
            time, low, high = one["time"], one.isel(quantile=0), one.isel(quantile=-1)
            label = PARAMETER_LABELS[str(parameter)]
            ax.fill_between(time, low, high, color=colour, alpha=0.2, lw=0, label=f"_{label}")
            ax.plot(time, take_middle(one), color=colour, linestyle=line, label=label)
    axes[0, 0].set_ylim(-0.02, 1.02)
    figure.supylabel("share of the variance", size=7)
    figure.legend(*axes[0, 0].get_legend_handles_labels(), loc="outside upper left", ncols=4)
    return figure


def take_middle(values: xr.DataArray) -> xr.DataArray:
    """Take the middle quantile, where there are quantiles."""
    if "quantile" not in values.dims:
        return values
    return values.isel(quantile=values.sizes["quantile"] // 2)


@styled
def draw_densities(densities: xr.Dataset) -> Figure:
    """Draw the joint angle's density at several times.

    Each density is scaled to its own peak and drawn on the line of its time, so that its peak is
    seen to move and widen, from a needle at the start to a hill at the end.

    Parameters
    ----------
    densities
        `density` (joint, time, angle) [1/rad] over `joint_angle` (joint, time, angle) [rad], and
        `density_bound` (joint, time, angle, bound).
    """
    joints, times = densities["joint"], densities["time"].values
    height = 0.7 + (0.5 + 0.18 * times.size) * measure_joint_rows(joints.size, 1)
    figure = new_figure(get_source(densities), height=height)
    axes = build_joint_axes(figure, joints.size, sharex=False, sharey=True)[0]
    colours = mpl.colormaps["viridis"](np.linspace(0, 0.9, times.size))
    for ax, joint in zip(axes, joints.values, strict=True):
        for place, colour in enumerate(colours):
            draw_ridge(ax, densities.sel(joint=joint).isel(time=place), -place, colour)
        ax.set(title=f"joint {joint}", xlabel=label_motion(densities))
        ax.set_yticks(-np.arange(times.size), [f"{time:g} s" for time in times])
    figure.supylabel("time", size=7)
    return figure


def draw_ridge(ax: Axes, densities: xr.Dataset, base: float, colour: np.ndarray) -> None:
    """Draw one density (angle) and its band.

    At its peak it is 1.6 lines high.
    """
    angle, density = densities["joint_angle"].values, densities["density"].values
    low, high = (densities["density_bound"].sel(bound=end).values for end in ("lower", "upper"))
    scale = 1.6 / np.nanmax(density)
    order = {"zorder": 2 - base}
    white = {"color": "white", "alpha": 0.7, "lw": 0, "label": "_"}
    ax.fill_between(angle, base, base + scale * density, **white, **order)
    order["label"] = f"_{float(densities['time']):g} s"
    ax.fill_between(
        angle, base + scale * low, base + scale * high, color=colour, alpha=0.25, lw=0, **order
    )
    ax.plot(angle, base + scale * density, color=colour, **order)
