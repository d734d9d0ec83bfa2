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
    curves, label = choose_curves(shown)
    x = curves[curves.dims[-1]]
    if label != "trial":
        load = shown["load"] / shown["load"].max() * float(curves.max())
        axes.fill_between(x, load, color=PALE, alpha=0.5, linewidth=0)
    style = "o-" if x.size < 20 else "-"
    axes.plot(x, curves.sel(model="without"), style, color=GREY, markersize=3)
    axes.plot(x, curves.sel(model="with"), style, color=BLUE, markersize=3)
    axes.set(xlabel=label, ylabel="joint angle [rad]")
    return figure


def choose_curves(shown: xr.Dataset) -> tuple[xr.DataArray, str]:
    """Choose the joint, and the trial or all, that an effect moves most.

    Returns
    -------
    (model, time) [rad] over time [s], or (model, trial) over the trial, and the name of that axis.
    """
    angle = shown["joint_angle"]
    moved = abs(angle.sel(model="with") - angle.sel(model="without")).max("frame")
    place = moved.argmax(("trial", "joint"))
    curves = angle.isel(joint=place["joint"])
    if shown.attrs["level"] == "between_trials":
        return curves.max("frame"), "trial"
    return curves.isel(trial=place["trial"]).swap_dims(frame="time"), "time [s]"
