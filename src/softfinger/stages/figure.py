"""Rule `figure`: one figure, for a document."""

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
    """Draw a figure once per file, by suffix."""
    write_figure(name, open_stated(artifacts, markers), figures)
