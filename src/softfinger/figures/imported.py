"""Motion and load of a few imported trials."""

import xarray as xr
from matplotlib.figure import Figure

from softfinger.figures.style import BLACK, BLUE, get_source, new_figure, styled


@styled
def draw_imported(curves: xr.Dataset) -> Figure:
    """Draw motion above load, one column per trial.

    Parameters
    ----------
    curves
        ``time``, ``motion`` and ``load`` (trial, frame); attributes ``motion`` and ``load`` label
        the axes.
    """
    trials = curves.sizes["trial"]
    figure = new_figure(get_source(curves), height=3.2)
    axes = figure.subplots(2, trials, squeeze=False, sharex="col")
    for k, name in enumerate(curves["trial"].values):
        one = curves.isel(trial=k)
        axes[0, k].plot(one["time"], one["motion"], color=BLACK, rasterized=True)
        axes[1, k].plot(one["time"], one["load"], color=BLUE, rasterized=True)
        axes[0, k].set(title=str(name))
        axes[1, k].set(xlabel="time [s]")
    axes[0, 0].set(ylabel=curves.attrs["motion"])
    axes[1, 0].set(ylabel=curves.attrs["load"])
    return figure
