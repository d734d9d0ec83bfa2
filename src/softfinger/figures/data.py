"""The numbers that a figure shows, as a table."""

import csv
import io
from collections.abc import Iterator
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection, PathCollection, PolyCollection, QuadMesh
from matplotlib.figure import Figure
from matplotlib.image import AxesImage
from matplotlib.lines import Line2D
from matplotlib.patches import Polygon, Rectangle

COLUMNS = ("panel", "title", "x_axis", "y_axis", "series", "x", "x_end", "y", "y_low", "y_high",
           "value")  # fmt: skip
"""One row is one point, bar, cell, or place of a band."""
COLOUR_BAR = "<colorbar>"
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
        for artist in (*ax.lines, *ax.collections, *ax.patches, *ax.images):
            for row in _list_artist(ax, artist):
                yield place | {"series": str(artist.get_label()).removeprefix("_")} | row


def _list_artist(ax: Axes, artist: Any) -> Iterator[Row]:
    """List what one artist shows; a label without a letter hides an ornament."""
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
        yield from _list_cells(ax, np.ma.filled(artist.get_array(), np.nan))
    elif isinstance(artist, Rectangle):
        x, height = float(artist.get_x()), float(artist.get_height())
        yield {"x": x, "x_end": x + float(artist.get_width()), "y": float(artist.get_y()) + height}
    elif isinstance(artist, Polygon):
        yield from _list_points(artist.get_xy())


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


def _list_cells(ax: Axes, values: np.ndarray) -> Iterator[Row]:
    """List the cells of a coloured table; a photograph has none."""
    if values.ndim != 2 or values.size > 10_000:
        return
    for row, column in np.ndindex(values.shape):
        if np.isfinite(values[row, column]):
            yield {"x": column, "y": row, "value": float(values[row, column])}
