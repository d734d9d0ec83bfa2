"""The distribution of the parameters over trials."""

from __future__ import annotations

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
    get_source,
    label_parameter_unit,
    new_figure,
    styled,
)

VISCOELASTIC = ("k_v", "c_v", "c_p")


@styled
def draw_parameter_histograms(population: xr.Dataset, load_unit: str) -> Figure:
    """Draw the trials' least-squares estimates and the fitted densities: parameter × joint.

    The axis is logarithmic, so a log-normal looks normal; densities are per unit of the natural
    logarithm. Open bars are the estimates that the paper's rule drops.

    Parameters
    ----------
    population
        `estimate` (trial, joint, parameter), `kept` (bool), `population_mean`, `population_sd`
        (joint, parameter) of the artifact `least_squares`; and, where there is a posterior, draws
        of it `mu`, `sigma` (sample, joint, parameter).
    load_unit
        `N m` or `command`.
    """
    figure = new_figure(get_source(population), height=0.5 + 1.35 * len(VISCOELASTIC))
    joints = population["joint"].values
    axes = figure.subplots(len(VISCOELASTIC), joints.size, squeeze=False)
    for row, parameter in zip(axes, VISCOELASTIC, strict=True):
        unit = label_parameter_unit(parameter, load_unit)
        for ax, joint in zip(row, joints, strict=True):
            draw_histogram(ax, population.sel(joint=joint, parameter=parameter), logarithmic=True)
            ax.set_xlabel(f"{PARAMETER_LABELS[parameter]} [{unit}]")
    return finish_histograms(figure, axes, joints, "density per unit of ln")


@styled
def draw_initial_angles(population: xr.Dataset) -> Figure:
    """Draw the distribution of the initial angle over trials, one panel per joint.

    Parameters
    ----------
    population
        As for `draw_parameter_histograms`; the parameter q_ini is normal on its own scale.
    """
    joints = population["joint"].values
    figure = new_figure(get_source(population), height=2.0)
    axes = figure.subplots(1, joints.size, squeeze=False)
    for ax, joint in zip(axes[0], joints, strict=True):
        draw_histogram(ax, population.sel(joint=joint, parameter="q_ini"), logarithmic=False)
        ax.set_xlabel(f"{PARAMETER_LABELS['q_ini']} [rad]")
    return finish_histograms(figure, axes, joints, "density [1/rad]")


def finish_histograms(figure: Figure, axes: np.ndarray, joints: np.ndarray, label: str) -> Figure:
    """Name joints and axes, and put one legend above."""
    for ax, joint in zip(axes[0], joints, strict=True):
        ax.set_title(f"joint {joint}")
    figure.supylabel(label, size=7)
    figure.legend(*axes[0, 0].get_legend_handles_labels(), loc="outside upper left", ncols=4)
    return figure


def draw_histogram(ax: Axes, population: xr.Dataset, *, logarithmic: bool) -> None:
    """Draw one parameter of one joint: bars of the estimates, curves of the densities."""
    estimate, kept = population["estimate"].values, population["kept"].values.astype(bool)
    usable = np.isfinite(estimate) & (estimate > 0 if logarithmic else True)
    value = np.where(usable, estimate, np.nan)
    value = np.log(value) if logarithmic else value
    used, dropped = value[usable & kept], value[usable & ~kept]
    mean, sd = float(population["population_mean"]), float(population["population_sd"])
    normals = [(mean, sd)] if sd > 0 else []  # a single trial has no spread, or NaN
    if "mu" in population:
        normals.append((float(population["mu"].median()), float(population["sigma"].median())))
    grid = choose_grid(used, normals)
    edges = choose_edges(used, grid)
    place = np.exp if logarithmic else np.asarray
    for values, style in ((used, {"color": PALE}), (dropped, {"color": "none", "ec": GREY})):
        height = np.histogram(values, edges)[0] / max(used.size, 1) / np.diff(edges)
        label = "trials kept" if values is used else "dropped" if dropped.size else None
        ax.bar(place(edges[:-1]), height, np.diff(place(edges)), align="edge", label=label, **style)
    if sd > 0:
        ax.plot(place(grid), density(grid, mean, sd), color=TWO_STAGE, ls="--", label="two-stage")
    if "mu" in population:
        curves = density(grid[:, None], population["mu"].values, population["sigma"].values)
        low, middle, high = np.quantile(curves, (0.05, 0.5, 0.95), axis=1)
        ax.fill_between(place(grid), low, high, color=POSTERIOR, alpha=0.25, linewidth=0)
        ax.plot(place(grid), middle, color=POSTERIOR, label="posterior")
    if logarithmic:
        ax.set_xscale("log")
        decades = (grid[-1] - grid[0]) / np.log(10)
        subs = (1,) if decades > 2 else (1, 3)
        ax.xaxis.set_major_locator(MaxNLocator(3) if decades < 1 else LogLocator(subs=subs))
        ax.xaxis.set_major_formatter("{x:g}")
        ax.xaxis.set_minor_locator(NullLocator())


def choose_grid(values: np.ndarray, normals: list[tuple[float, float]]) -> np.ndarray:
    """Choose the stretch to draw: 3.2 sd of each normal, and the middle 98 % of the trials.

    >>> choose_grid(np.array([]), [(1.0, 0.5)])[[0, -1]].round(2)
    array([-0.6,  2.6])
    """
    ends = [end for mean, sd in normals for end in (mean - 3.2 * sd, mean + 3.2 * sd)]
    ends += [float(end) for end in np.quantile(values, (0.01, 0.99))] if values.size else []
    low, high = min(ends, default=-1.0), max(ends, default=1.0)
    margin = 0.0 if high > low else 0.5
    return np.linspace(low - margin, high + margin, 161)


def choose_edges(values: np.ndarray, grid: np.ndarray) -> np.ndarray:
    """Choose edges of bars over the whole stretch, as wide as suits the kept trials."""
    bars = np.clip(1.5 * np.sqrt(values.size), 6, 24)
    span = grid[-1] - grid[0]
    width = np.ptp(values) / bars if values.size > 1 else span / bars
    count = int(np.clip(np.ceil(span / width), 6, 60)) if width > 0 else 6
    return np.linspace(grid[0], grid[-1], count + 1)


def density(value: np.ndarray, mean: np.ndarray | float, sd: np.ndarray | float) -> np.ndarray:
    """Normal density.

    >>> round(float(density(0.0, 0.0, 1.0)), 4)
    0.3989
    """
    return np.exp(-0.5 * ((value - mean) / sd) ** 2) / (np.sqrt(2 * np.pi) * sd)
