"""Rule `figure`: one figure, for a document.

The figure is the paper's or ours.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from softfinger.report.publication import write_figure
from softfinger.stages.opening import open_stated


def figure(
    *,
    name: str,
    figures: Sequence[Path],
    markers: Sequence[Path],
    **artifacts: Path,
) -> None:
    """Draw one figure once per file.

    The suffix of the file decides its form.
    """
    write_figure(name, open_stated(artifacts, markers), figures)
