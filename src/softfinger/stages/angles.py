"""Rule `angles`: joint angles and loads of trials."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from softfinger.artifacts import open_artifact, save_artifact
from softfinger.artifacts.specs import angles as angles_spec
from softfinger.artifacts.specs import markers as markers_spec
from softfinger.campaign import read_campaign
from softfinger.provenance import describe_run
from softfinger.tracking import assemble_angles


def angles(
    *,
    folder: Path,
    tables: Sequence[Path],
    markers: Sequence[Path],
    angles: Path,
    config: Mapping[str, Any],
) -> None:
    """Write the joint angles of a campaign."""
    provenance = describe_run("angles", {"tables": tables, "markers": markers}, config)
    tracked = [open_artifact(path, markers_spec.SPEC) for path in markers]
    found = assemble_angles(read_campaign(folder), tracked, config)
    save_artifact(found, angles_spec.SPEC, angles, provenance)
