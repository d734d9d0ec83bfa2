"""A figure inside a page."""

from __future__ import annotations

import base64
from html import escape
from typing import TYPE_CHECKING

from softfinger.figures.style import render_figure

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def embed_figure(figure: Figure, words: str) -> str:
    """Embed a figure as an image; `words` are for those who cannot see it."""
    code = base64.b64encode(render_figure(figure, "svg")).decode()
    return f'<img class="plot" src="data:image/svg+xml;base64,{code}" alt="{escape(words)}">'
