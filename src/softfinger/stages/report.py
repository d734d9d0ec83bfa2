"""Rule `report`: one page per campaign."""

from __future__ import annotations

import subprocess
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import xarray as xr

from softfinger.artifacts import open_artifact, open_tree, write_atomically
from softfinger.artifacts.specs import (
    angles,
    assumptions,
    bands,
    densities,
    free_form,
    least_squares,
    location,
    masking,
    picture,
    posterior,
    ranking,
    repair,
    sampling,
    shapley,
    sobol,
    tracking_quality,
)
from softfinger.artifacts.specs import (
    markers as markers_spec,
)
from softfinger.mismatch.verdict import read_verdict
from softfinger.provenance import PROJECT
from softfinger.report import write_report

SPECS = {
    spec.SPEC.name: spec.SPEC
    for spec in (
        angles,
        least_squares,
        posterior,
        sampling,
        bands,
        densities,
        sobol,
        shapley,
        assumptions,
    )
}
DIAGNOSED = {spec.SPEC.name: spec.SPEC for spec in (ranking, location, masking, repair, free_form)}
FILMED = {spec.SPEC.name: spec.SPEC for spec in (picture, tracking_quality)}


def report(
    *, report: Path, markers: Sequence[Path], config: Mapping[str, Any], **artifacts: Path
) -> None:
    """Write the report of a campaign from its artifacts.

    Parameters
    ----------
    report
        The page.
    markers
        Marker files, if the campaign was filmed; the first one is shown.
    config
        The whole configuration.
    **artifacts
        Name → file, for every name in ``SPECS``, those in ``FILMED`` if there are videos, and
        those in ``DIAGNOSED`` and `verdict` if there is a diagnosis.
    """
    with write_atomically(report) as temporary:
        write_report(open_artifacts(artifacts, markers), config, temporary, _find_commit())


def open_artifacts(
    artifacts: Mapping[str, Path], markers: Sequence[Path]
) -> dict[str, xr.Dataset | xr.DataTree]:
    """Open artifacts by name, and of the markers' files the first."""
    specs = SPECS | FILMED | DIAGNOSED
    opened = {
        name: (open_tree if specs[name].groups else open_artifact)(path, specs[name])
        for name, path in artifacts.items()
        if name != "verdict"
    }
    if "verdict" in artifacts:
        opened["verdict"] = read_verdict(artifacts["verdict"]).model_dump(mode="json")
    if markers:
        opened["markers"] = open_artifact(markers[0], markers_spec.SPEC)
    return opened


def _find_commit() -> str | None:
    """Commit of the code, where it comes from a git checkout."""
    command = ["git", "-C", str(PROJECT), "describe", "--always", "--dirty", "--abbrev=12"]
    try:
        return subprocess.run(command, capture_output=True, text=True, check=True).stdout.strip()
    except (OSError, subprocess.CalledProcessError):
        return None
