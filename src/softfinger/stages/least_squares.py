"""Rule `least_squares`: the paper's two stages."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from softfinger.artifacts import open_artifact, save_artifact
from softfinger.artifacts.specs import angles as angles_spec
from softfinger.artifacts.specs import least_squares as least_squares_spec
from softfinger.estimation.least_squares import fit_least_squares
from softfinger.provenance import describe_run
from softfinger.stages.linear_algebra import on_one_thread


@on_one_thread
def least_squares(*, angles: Path, least_squares: Path, config: Mapping[str, Any]) -> None:
    """Write trials' least-squares estimates and their distributions."""
    provenance = describe_run("least_squares", {"angles": angles}, config)
    fitted = fit_least_squares(open_artifact(angles, angles_spec.SPEC), config)
    save_artifact(fitted, least_squares_spec.SPEC, least_squares, provenance)
