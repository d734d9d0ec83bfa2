"""The numbers that a figure shows, as a table."""

import csv
import io
from collections.abc import Iterator
from itertools import islice
from typing import Any

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.axis import Axis
from matplotlib.collections import LineCollection, PathCollection, PolyCollection, QuadMesh
from matplotlib.figure import Figure
from matplotlib.image import AxesImage
from matplotlib.lines import Line2D
from matplotlib.patches import Patch, Polygon, Rectangle
from matplotlib.ticker import FixedLocator

COLUMNS = ("panel", "title", "x_axis", "y_axis", "series", "x", "x_end", "y", "y_low", "y_high",
           "value")  # fmt: skip
"""One row is one point, bar, cell, or place of a band."""
COLOUR_BAR, ORNAMENT = "<colorbar>", "_"
"""Labels of what shows no numbers."""
Row = dict[str, Any]


def write_data(figure: Figure) -> str:
    """Write what a figure shows as CSV, with `COLUMNS`; a photograph is left out.

    >>> figure = Figure()
    >>> _ = figure.subplots().plot([1.0, 2.0], [3.0, 4.0], label="angle")
    >>> write_data(figure).splitlines()[1]
    '1,,,,angle,1,,3,,,'
    """
    file = io.StringIO()
    writer = csv.DictWriter(file, COLUMNS, lineterminator="\n")
    writer.writeheader()
    for row in list_data(figure):
        numbers = {key: f"{v:.7g}" for key, v in row.items() if isinstance(v, float)}
        writer.writerow(row | numbers)
    return file.getvalue()


def list_data(figure: Figure) -> Iterator[Row]:
    """List the rows of a figure's table, panel by panel."""
    panels = [ax for ax in figure.axes if ax.get_label() != COLOUR_BAR and ax.axison]
    for number, ax in enumerate(panels, start=1):
        axes = {"x_axis": ax.get_xlabel(), "y_axis": ax.get_ylabel()}
        place = {"panel": number, "title": ax.get_title(loc="left"), **axes}
        names = {"x": _name_ticks(ax.xaxis), "y": _name_ticks(ax.yaxis)}
        for label, artist, rows in _list_artists(ax):
            unknown = _list_free(ax, artist)
            for row in islice(rows, 1 if unknown else None):
                for key, known in names.items():
                    here = row.get(key)
                    middle = here + 0.5 if "value" in row else here  # of a cell
                    row[key] = known.get(here) or known.get(middle) or here
                seen = {key: value for key, value in row.items() if key[0] != unknown}
                yield place | {"series": label.removeprefix("_")} | seen


def _list_artists(ax: Axes) -> Iterator[tuple[str, Artist, Iterator[Row]]]:
    """List label, artist and rows of everything that shows numbers."""
    bars = {id(bar): box for box in ax.containers for bar in box}
    for artist in (*ax.lines, *ax.collections, *ax.patches, *ax.images):
        box = bars.get(id(artist))
        label = str((box or artist).get_label())
        if label != ORNAMENT:
            lies = box is not None and box.orientation == "horizontal"
            yield label, artist, _list_lying_bar(artist) if lies else _list_artist(artist)


def _list_free(ax: Axes, artist: Artist) -> str:
    """The axis along which a line or span has no place, or an empty string."""
    patch = isinstance(artist, Patch)
    transform = artist.get_data_transform() if patch else artist.get_transform()
    free = {"y": ax.get_xaxis_transform(which="grid"), "x": ax.get_yaxis_transform(which="grid")}
    return next((name for name, one in free.items() if transform == one), "")


def _name_ticks(axis: Axis) -> dict[float, str]:
    """Names of the places of an axis that has names for numbers."""
    if not isinstance(axis.get_major_locator(), FixedLocator):
        return {}
    places = axis.get_ticklocs()
    labels = axis.get_major_formatter().format_ticks(places)
    return {float(place): label for place, label in zip(places, labels, strict=True) if label}


def _list_artist(artist: Artist) -> Iterator[Row]:
    """List what one artist shows."""
    if isinstance(artist, Line2D):
        yield from _list_points(np.column_stack([artist.get_xdata(), artist.get_ydata()]))
    elif isinstance(artist, LineCollection):
        for segment in artist.get_segments():
            yield from _list_points(np.asarray(segment))
    elif isinstance(artist, PathCollection):
        yield from _list_points(np.asarray(artist.get_offsets()))
    elif isinstance(artist, PolyCollection):
        for path in artist.get_paths():
            yield from _list_band(path.vertices)
    elif isinstance(artist, QuadMesh | AxesImage):
        yield from _list_cells(np.ma.filled(artist.get_array(), np.nan))
    elif isinstance(artist, Rectangle):
        x, height = float(artist.get_x()), float(artist.get_height())
        yield {"x": x, "x_end": x + float(artist.get_width()), "y": float(artist.get_y()) + height}
    elif isinstance(artist, Polygon):
        yield from _list_points(artist.get_xy())


def _list_lying_bar(bar: Rectangle) -> Iterator[Row]:
    yield {"x": float(bar.get_width()), "y": float(bar.get_y() + bar.get_height() / 2)}


def _list_points(points: np.ndarray) -> Iterator[Row]:
    for x, y in np.asarray(points, float):
        if np.isfinite(x) or np.isfinite(y):
            yield {"x": float(x), "y": float(y)}


def _list_band(vertices: np.ndarray) -> Iterator[Row]:
    """List a filled band: `fill_between` goes along one edge and back along the other."""
    half = (len(vertices) - 3) // 2
    lower, upper = vertices[1 : half + 1], vertices[half + 2 : 2 * half + 2][::-1]
    for (x, one), (_, other) in zip(lower, upper, strict=True):
        yield {"x": float(x), "y_low": float(min(one, other)), "y_high": float(max(one, other))}


def _list_cells(values: np.ndarray) -> Iterator[Row]:
    """List the cells of a coloured table; a photograph has none."""
    if values.ndim != 2 or values.size > 10_000:
        return
    for row, column in np.ndindex(values.shape):
        if np.isfinite(values[row, column]):
            yield {"x": float(column), "y": float(row), "value": float(values[row, column])}
