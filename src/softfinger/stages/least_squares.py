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
from softfinger.stages.modelled import read_modelled


@on_one_thread
def least_squares(
    *, angles: Path, least_squares: Path, config: Mapping[str, Any], model: Path | None = None
) -> None:
    """Write trials' least-squares estimates and their distributions.

    Of a model file only its `measurement` counts: the paper's way knows no effects.
    """
    roles = {"angles": angles} if model is None else {"angles": angles, "model": model}
    provenance = describe_run("least_squares", roles, config)
    recorded = open_artifact(angles, angles_spec.SPEC)
    known = read_modelled(recorded, provenance.inputs["angles"], model)
    fitted = fit_least_squares(known.angles, config)
    save_artifact(fitted, least_squares_spec.SPEC, least_squares, provenance)
