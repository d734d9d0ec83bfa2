"""The artifacts that `summarise`, `report` and the figures read."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from softfinger.artifacts import open_artifact, open_tree
from softfinger.artifacts.declared_units import state_in_declared_units
from softfinger.artifacts.specs import (
    angles,
    assumptions,
    bands,
    checks,
    densities,
    doubts,
    free_form,
    laws,
    least_squares,
    location,
    masking,
    measurement,
    picture,
    posterior,
    ranking,
    repair,
    sampling,
    shapley,
    sobol,
    summary,
    tracking_quality,
)
from softfinger.artifacts.specs import markers as markers_spec
from softfinger.artifacts.verdict import read_verdict

SPECS = {
    part.SPEC.name: part.SPEC
    for part in (
        angles,
        doubts,
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
DIAGNOSED = {
    part.SPEC.name: part.SPEC
    for part in (ranking, location, masking, repair, free_form, laws, measurement)
}
FILMED = {part.SPEC.name: part.SPEC for part in (picture, tracking_quality)}
SUMMED = {part.SPEC.name: part.SPEC for part in (checks, summary)}
"""What `summarise` makes of the others."""


def open_artifacts(artifacts: Mapping[str, Path], markers: Sequence[Path]) -> dict[str, Any]:
    """Open artifacts by name; of markers the first."""
    specs = SPECS | FILMED | DIAGNOSED | SUMMED
    opened: dict[str, Any] = {
        name: (open_tree if specs[name].groups else open_artifact)(path, specs[name])
        for name, path in artifacts.items()
        if name != "verdict"
    }
    if "verdict" in artifacts:
        opened["verdict"] = read_verdict(artifacts["verdict"]).model_dump(mode="json")
    if markers:
        opened["markers"] = open_artifact(markers[0], markers_spec.SPEC)
    return opened


def open_stated(artifacts: Mapping[str, Path], markers: Sequence[Path]) -> dict[str, Any]:
    """Open artifacts, a specimen's motion in the declared unit."""
    return state_in_declared_units(open_artifacts(artifacts, markers))
