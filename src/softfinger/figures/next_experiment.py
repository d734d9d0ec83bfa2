"""What the survivors predict under a plan, and where they part."""

import xarray as xr
from matplotlib.figure import Figure

from softfinger.figures.style import (
    BLACK,
    BLUE,
    GREEN,
    GREY,
    ORANGE,
    PINK,
    RED,
    get_source,
    new_figure,
    styled,
)

COLOURS = (BLACK, BLUE, RED, GREEN, ORANGE, PINK)


@styled
def draw_next_experiment(planned: xr.Dataset) -> Figure:
    """Draw load, predicted angles and their differences.

    Of the trial and joint where the models part most, each adapted to the first.

    Parameters
    ----------
    planned
        load_time, load (knot); shown (survivor, time), the motion; apart (survivor, time), in sds
        of the noise; attrs protocol, load_label, motion_label.
    """
    figure = new_figure(get_source(planned), height=4.2)
    top, middle, low = figure.subplots(3, 1, sharex=True, height_ratios=[1, 1.4, 1.4])
    top.plot(planned["load_time"], planned["load"], color=GREY)
    top.set(ylabel=planned.attrs["load_label"], title=f"protocol: {planned.attrs['protocol']}")
    time = planned["time"].values
    for number, name in enumerate(planned["survivor"].values):
        colour, style = COLOURS[number % len(COLOURS)], "-" if number == 0 else "--"
        middle.plot(time, planned["shown"].values[number], style, color=colour, label=str(name))
        low.plot(time, planned["apart"].values[number], style, color=colour)
    low.axhspan(-1.0, 1.0, color=GREY, alpha=0.2, linewidth=0)
    middle.set(ylabel=planned.attrs["motion_label"])
    low.set(xlabel="time [s]", ylabel="difference / noise sd")
    figure.legend(*middle.get_legend_handles_labels(), loc="outside lower center", ncols=3)
    return figure
