"""Formulas as MathML, which a browser sets by itself: no script, no network, no LaTeX."""

from typing import Any

from docutils import nodes
from docutils.utils.math import math2html, tex2unichar  # noqa: F401  (loads docutils' tables)
from docutils.utils.math.latex2mathml import tex2mathml
from sphinx.application import Sphinx


def render_inline(translator: Any, node: nodes.math) -> None:  # noqa: ANN401 (Sphinx's own)
    """Set a formula within a line."""
    translator.body.append(tex2mathml(node.astext(), as_block=False))
    raise nodes.SkipNode


def render_block(translator: Any, node: nodes.math_block) -> None:  # noqa: ANN401
    """Set a formula on lines of its own; a wide one scrolls."""
    formula = tex2mathml(node.astext(), as_block=True)
    region = '<div class="formula" tabindex="0" role="region" aria-label="formula">'
    translator.body.append(f"{region}{formula}</div>")
    raise nodes.SkipNode


def setup(app: Sphinx) -> dict[str, bool]:
    """Register the renderer."""
    app.add_html_math_renderer("mathml", (render_inline, None), (render_block, None))
    return {"parallel_read_safe": True, "parallel_write_safe": True}
