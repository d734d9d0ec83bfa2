"""Rule `document`: figures and parameters as LaTeX."""

from collections.abc import Sequence
from pathlib import Path

from softfinger.artifacts import write_atomically
from softfinger.report.publication import write_document, write_parameter_table
from softfinger.stages.opening import open_stated


def document(
    *,
    names: Sequence[str],
    table: Path,
    document: Path,
    markers: Sequence[Path],
    **artifacts: Path,
) -> None:
    """Write a document, and its table of parameters."""
    opened = open_stated(artifacts, markers)
    with write_atomically(table) as temporary:
        write_parameter_table(opened, temporary)
    with write_atomically(document) as temporary:
        write_document(names, opened, temporary)
