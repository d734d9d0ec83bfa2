"""Rule `picture`: one frame for the report."""

from collections.abc import Sequence
from pathlib import Path

from softfinger.artifacts import open_artifact, save_artifact
from softfinger.artifacts.specs import markers as markers_spec
from softfinger.artifacts.specs import picture as picture_spec
from softfinger.campaign import read_campaign
from softfinger.provenance import describe_run
from softfinger.tracking.picture import take_picture


def picture(
    *,
    folder: Path,
    tables: Sequence[Path],
    videos: Sequence[Path],
    markers: Path,
    picture: Path,
) -> None:
    """Write the first trial's most bent frame."""
    inputs = {"tables": tables, "videos": videos, "markers": markers}
    provenance = describe_run("picture", inputs, {})
    found = open_artifact(markers, markers_spec.SPEC)
    save_artifact(
        take_picture(read_campaign(folder), found), picture_spec.SPEC, picture, provenance
    )
