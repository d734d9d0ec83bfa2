"""Rule `figure`: one figure of the paper or ours, in forms that a document takes."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from softfinger.report.publication import write_figure
from softfinger.stages.report import open_artifacts


def figure(
    *,
    name: str,
    figures: Sequence[Path],
    markers: Sequence[Path],
    config: Mapping[str, Any],
    **artifacts: Path,
) -> None:
    """Draw one figure, once per file, in the form of its suffix."""
    write_figure(name, open_artifacts(artifacts, markers), config, figures)
