"""A small picture of what an effect does."""

import xarray as xr
from matplotlib.figure import Figure

from softfinger.figures.style import BLUE, GREY, PALE, styled

SIZE_INCH = (2.3, 1.5)


@styled
def plot_effect(shown: xr.Dataset) -> Figure:
    """Plot the joint that an effect moves most.

    Parameters
    ----------
    shown
        Of `demonstrate_effect`: an effect between trials is plotted against the trial, at the
        largest angle; any other against time, in the trial that it moves most.
    """
    figure = Figure(figsize=SIZE_INCH, layout="constrained")
    axes = figure.subplots()
    angle = shown["joint_angle"]
    moved = abs(angle.sel(model="with") - angle.sel(model="without")).max("frame")
    place = moved.argmax(("trial", "joint"))
    curves = angle.isel(joint=place["joint"])
    if shown.attrs["level"] == "between_trials":
        curves, x, label = curves.max("frame"), shown["trial"], "trial"
    else:
        curves, x, label = curves.isel(trial=place["trial"]), shown["time"], "time [s]"
        load = shown["load"] / shown["load"].max() * float(curves.max())
        axes.fill_between(x, load, color=PALE, alpha=0.5, linewidth=0)
    style = "o-" if x.size < 20 else "-"
    axes.plot(x, curves.sel(model="without"), style, color=GREY, markersize=3)
    axes.plot(x, curves.sel(model="with"), style, color=BLUE, markersize=3)
    axes.set(xlabel=label, ylabel="joint angle [rad]")
    return figure
