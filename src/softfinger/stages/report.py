"""Rule `report`: one page per campaign."""

import subprocess
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from softfinger.artifacts import write_atomically
from softfinger.provenance import PROJECT
from softfinger.report import write_report
from softfinger.stages.opening import open_stated


def report(
    *, report: Path, markers: Sequence[Path], config: Mapping[str, Any], **artifacts: Path
) -> None:
    """Write the report of a campaign from its artifacts.

    Parameters
    ----------
    markers
        Marker files, if the campaign was filmed; the first one is shown.
    **artifacts
        Name → file, for every name in ``opening.SPECS`` and ``SUMMED``, those in ``FILMED`` if
        there are videos, and those in ``DIAGNOSED`` and `verdict` if there is a diagnosis.
    """
    with write_atomically(report) as temporary:
        write_report(open_stated(artifacts, markers), config, temporary, _find_commit())


def _find_commit() -> str | None:
    """Commit of the code, from a git checkout.

    An installed package may lie within a checkout of something else.
    """
    if not (PROJECT / ".git").exists():
        return None
    command = ["git", "-C", str(PROJECT), "describe", "--always", "--dirty", "--abbrev=12"]
    try:
        return subprocess.run(command, capture_output=True, text=True, check=True).stdout.strip()
    except (OSError, subprocess.CalledProcessError):
        return None
