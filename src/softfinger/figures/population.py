"""The distribution of the parameters over trials."""

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import LogLocator, MaxNLocator, NullLocator

from softfinger.figures.style import (
    GREY,
    PALE,
    PARAMETER_LABELS,
    POSTERIOR,
    TWO_STAGE,
    get_motion_unit,
    get_source,
    label_parameter_unit,
    new_figure,
    styled,
)

VISCOELASTIC = ("k_v", "c_v", "c_p")


@styled
def draw_parameter_histograms(population: xr.Dataset, load_unit: str) -> Figure:
    """Draw the trials' estimates and the fitted densities.

    The axis is logarithmic, so a log-normal looks normal; densities are per unit of the natural
    logarithm. Open bars are the estimates that the paper's rule drops.

    Parameters
    ----------
    population
        The group `histograms` of the artifact `summary`: bar_edge, kept_density, dropped_density,
        abscissa, two_stage_density, posterior_density (joint, parameter, …).
    load_unit
        `N m` or `command`.
    """
    figure = new_figure(get_source(population), height=0.5 + 1.35 * len(VISCOELASTIC))
    joints = population["joint"].values
    axes = figure.subplots(len(VISCOELASTIC), joints.size, squeeze=False)
    for row, parameter in zip(axes, VISCOELASTIC, strict=True):
        unit = label_parameter_unit(parameter, load_unit, get_motion_unit(population))
        for ax, joint in zip(row, joints, strict=True):
            draw_histogram(ax, population.sel(joint=joint, parameter=parameter), logarithmic=True)
            ax.set_xlabel(f"{PARAMETER_LABELS[parameter]} [{unit}]")
    return finish_histograms(figure, axes, joints, "density per unit of ln")


@styled
def draw_initial_angles(population: xr.Dataset) -> Figure:
    """Draw each joint's distribution of initial angles over trials.

    Parameters
    ----------
    population
        As for `draw_parameter_histograms`; the parameter q_ini is normal on its own scale.
    """
    joints, unit = population["joint"].values, get_motion_unit(population)
    figure = new_figure(get_source(population), height=2.0)
    axes = figure.subplots(1, joints.size, squeeze=False)
    for ax, joint in zip(axes[0], joints, strict=True):
        draw_histogram(ax, population.sel(joint=joint, parameter="q_ini"), logarithmic=False)
        ax.set_xlabel(f"{PARAMETER_LABELS['q_ini']} [{unit}]")
    return finish_histograms(figure, axes, joints, f"density [1/{unit}]")


def finish_histograms(figure: Figure, axes: np.ndarray, joints: np.ndarray, label: str) -> Figure:
    """Name joints and axes, and put one legend above."""
    for ax, joint in zip(axes[0], joints, strict=True):
        ax.set_title(f"joint {joint}")
    figure.supylabel(label, size=7)
    figure.legend(*axes[0, 0].get_legend_handles_labels(), loc="outside upper left", ncols=4)
    return figure


def draw_histogram(ax: Axes, population: xr.Dataset, *, logarithmic: bool) -> None:
    """Draw one joint's estimates as bars, and densities."""
    edges = drop_missing(population["bar_edge"].values)
    for name, label, style in (
        ("kept_density", "trials kept", {"color": PALE}),
        ("dropped_density", "dropped", {"color": "none", "ec": GREY}),
    ):
        height = drop_missing(population[name].values)
        shown = label if height.any() or name == "kept_density" else "_"
        ax.bar(edges[:-1], height, np.diff(edges), align="edge", label=shown, **style)
    place, two_stage = (population[n].values for n in ("abscissa", "two_stage_density"))
    if np.isfinite(two_stage).all():
        ax.plot(place, two_stage, color=TWO_STAGE, ls="--", label="two-stage")
    low, middle, high = population["posterior_density"].transpose("quantile", "place").values
    if np.isfinite(middle).all():
        ax.fill_between(place, low, high, color=POSTERIOR, alpha=0.25, lw=0, label="_posterior")
        ax.plot(place, middle, color=POSTERIOR, label="posterior")
    if logarithmic:
        label_decades(ax, place[-1] / place[0])


def drop_missing(values: np.ndarray) -> np.ndarray:
    """Drop the NaN that fill an array up.

    >>> drop_missing(np.array([1.0, np.nan]))
    array([1.])
    """
    return values[np.isfinite(values)]


def label_decades(ax: Axes, ratio: float) -> None:
    """Label a logarithmic axis in plain numbers."""
    ax.set_xscale("log")
    subs = (1,) if ratio > 100 else (1, 3)
    ax.xaxis.set_major_locator(MaxNLocator(3) if ratio < 10 else LogLocator(subs=subs))
    ax.xaxis.set_major_formatter("{x:g}")
    ax.xaxis.set_minor_locator(NullLocator())
