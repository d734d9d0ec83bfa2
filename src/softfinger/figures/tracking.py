"""What the tracking saw: one frame with its markers."""

import re

import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from softfinger.figures.style import (
    BLUE,
    GREEN,
    GREY,
    ORANGE,
    PINK,
    RED,
    SINGLE_COLUMN,
    SKY,
    get_source,
    new_figure,
    styled,
)

LINK_COLOURS = (ORANGE, SKY, PINK, GREEN, BLUE)


@styled
def draw_tracking(trial: xr.Dataset, frame: int, image: xr.DataArray | None = None) -> Figure:
    """Draw the markers of one frame.

    Rings are found markers, crosses are flagged ones; thin lines are the paths that the markers
    take over the whole trial. Each link has its colour.

    Parameters
    ----------
    trial
        One trial of the artifact `markers`.
    image
        Its picture, (row, column) grey or (row, column, channel) RGB.
    """
    figure = new_figure(get_source(trial), height=3.0, width=SINGLE_COLUMN)
    ax = figure.subplots()
    if image is not None:
        grey = image.ndim == 2
        ax.imshow(image.values, cmap="gray" if grey else None, vmin=0 if grey else None)
    draw_links(ax, trial, frame)
    ax.set(xlabel="x [px]", ylabel="y [px], downwards", aspect="equal")
    ax.grid(visible=image is None)
    if image is None:
        ax.invert_yaxis()
    figure.legend(loc="outside lower center", ncols=4)
    return figure


def name_link(marker: str) -> str:
    """Return the link that a marker sits on.

    >>> name_link("link_12_2"), name_link("base_1")
    ('link 12', 'base')
    """
    return re.sub(r"_\d+$", "", marker).replace("_", " ")


def draw_links(ax: Axes, trial: xr.Dataset, frame: int) -> None:
    """Draw a trial's marker paths (frame, marker, axis)."""
    names = [name_link(str(name)) for name in trial["marker"].values]
    links = list(dict.fromkeys(names))
    for place, link in enumerate(links):
        here = trial.isel(marker=[i for i, name in enumerate(names) if name == link])
        colour = GREY if link == "base" else LINK_COLOURS[(place - 1) % len(LINK_COLOURS)]
        path = here["marker_position"].transpose("axis", "frame", "marker").values
        ax.plot(*path, color=colour, linewidth=0.5, alpha=0.7, label=f"_{link}, path")
        x, y = path[:, frame]
        ax.plot(x, y, color=colour, linewidth=1.2, label=f"_{link}, line")
        style = {"mec": colour, "color": "none", "mfc": "none", "mew": 1.4, "ls": "none"}
        ax.plot(x, y, "o", markersize=9, label=link, **style)
        flagged = here["marker_flag"].isel(frame=frame).values > 0
        ax.plot(x[flagged], y[flagged], "x", color=RED, markersize=7, label="_in doubt")
