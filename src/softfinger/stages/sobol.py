"""Rule `sobol`: which parameter's spread causes the spread of the joint angles."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from softfinger.artifacts import open_artifact, open_tree, save_artifact
from softfinger.artifacts.specs import angles as angles_spec
from softfinger.artifacts.specs import least_squares as least_squares_spec
from softfinger.artifacts.specs import posterior as posterior_spec
from softfinger.artifacts.specs import sobol as sobol_spec
from softfinger.propagation import compute_sobol
from softfinger.provenance import describe_run
from softfinger.stages.linear_algebra import on_one_thread


@on_one_thread
def sobol(
    *,
    angles: Path,
    least_squares: Path,
    posterior: Path,
    sobol: Path,
    config: Mapping[str, Any],
    seed: int,
) -> None:
    """Write the Sobol indices of the joint angles over time."""
    roles = {"angles": angles, "least_squares": least_squares, "posterior": posterior}
    provenance = describe_run("sobol", roles, config, seed)
    indices = compute_sobol(
        open_artifact(angles, angles_spec.SPEC),
        open_artifact(least_squares, least_squares_spec.SPEC),
        open_tree(posterior, posterior_spec.SPEC),
        config,
    )
    save_artifact(indices, sobol_spec.SPEC, sobol, provenance)
