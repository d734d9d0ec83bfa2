"""Figures of the motion's spread and its causes."""

import numpy as np
import xarray as xr

from softfinger.figures.propagation import draw_densities, draw_shapley, draw_sobol
from softfinger.report.blocks import Picture
from softfinger.report.formatting import capital, count_things, format_number
from softfinger.report.material import Material


def count_source(material: Material, name: str) -> str:
    """Sentence with a figure's number of trials and origin."""
    n = count_things(material.angles["trial"].size, "trial")
    return f"n = {n}. {capital(material.cite(name))}."


def picture_sobol(material: Material) -> Picture | None:
    """Sobol indices over time."""
    if "sobol" not in material:
        return None
    return Picture(
        "sobol",
        "Which parameter causes the spread",
        draw_sobol(select_sobol(material.get("sobol"))),
        "First-order Sobol indices of four parameters over time, all of it and the first second.",
        "Sobol indices: share of the variance between trials that a parameter explains alone "
        "(thick), and with the others (thin); bands: 90 % of the "
        f"posterior. Below: the first second. {count_source(material, 'sobol')}",
    )


def picture_shapley(material: Material) -> Picture | None:
    """Shapley effects over time."""
    if "shapley" not in material:
        return None
    return Picture(
        "shapley",
        "The same for correlated parameters",
        draw_shapley(material.get("shapley")),
        "Shapley effects of four parameters over time, one panel for each joint, with bands.",
        "Share of the variance between trials that each parameter gets if correlated ones "
        "share what they cause together (Shapley effects); the shares sum to 1. Bands: equal-"
        f"tailed interval over the posterior's draws, 90 %. {count_source(material, 'shapley')}",
    )


def select_sobol(sobol: xr.Dataset) -> xr.Dataset:
    """Select the posterior's Sobol indices and rename their quantiles.

    The names are those that the figures draw.
    """
    chosen = sobol.sel(estimate="posterior") if "estimate" in sobol.dims else sobol
    for name in ("first_order", "total"):
        if f"{name}_quantile" in chosen:
            chosen = chosen.assign({name: chosen[f"{name}_quantile"]})
    return chosen


def picture_densities(material: Material) -> Picture | None:
    """Density of the joint angle over time."""
    if "densities" not in material:
        return None
    densities = material.get("densities").sel(estimate="posterior")
    densities = densities.sel(time=densities["time"] <= float(material.recordings["duration"]))
    shown = np.floor(1e3 * float(densities["probability_shown"].min())) / 10
    return Picture(
        "densities",
        "Density of the joint angle over time",
        draw_densities(densities),
        "Density of the joint angle at several times; its peak moves and widens.",
        "Density of the joint angle of a new trial at several times, each scaled to its own peak: "
        "it moves and widens. Lines: mean over the posterior's draws; within the bands lie 90 % of "
        f"the draws' densities (equal tails). At least {format_number(shown)} % of the probability "
        f"lies within the angles drawn. {count_source(material, 'densities')}",
    )
