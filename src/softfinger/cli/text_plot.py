"""Curves as text, for a terminal."""

from collections.abc import Mapping

import numpy as np
from numpy.typing import ArrayLike

WIDTH, HEIGHT = 64, 12


def plot_text(x: ArrayLike, curves: Mapping[str, ArrayLike], label: str) -> list[str]:
    """Draw curves over x (n,) as lines of text.

    Each is drawn by the first sign of its name; later ones lie on top.

    >>> plot_text([0.0, 1.0], {"o up": [0.0, 1.0]}, "time")[1]
    '      │                                                       oooooo'
    """
    x = np.asarray(x, float)
    fine = np.linspace(x[0], x[-1], WIDTH)
    every = np.array([np.interp(fine, x, np.asarray(y, float)) for y in curves.values()])
    low, high = float(every.min()), float(every.max())
    rows = np.rint((high - every) / max(high - low, 1e-300) * (HEIGHT - 1)).astype(int)
    canvas = np.full((HEIGHT, WIDTH), " ")
    for name, row in zip(curves, rows, strict=True):
        canvas[row, np.arange(WIDTH)] = name[0]
    lines = [f"      │{''.join(row)}".rstrip() for row in canvas]
    lines[0] = f"{high:6.2g}┤{''.join(canvas[0])}".rstrip()
    lines[-1] = f"{low:6.2g}┤{''.join(canvas[-1])}".rstrip()
    axis = f"      └{'─' * WIDTH}"
    ends = f"{x[0]:g}".ljust(WIDTH - 8) + f"{x[-1]:g}".rjust(8)
    return [*lines, axis, f"       {ends}", f"       {label}; {', '.join(curves)}"]
