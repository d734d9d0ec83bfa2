"""Rule `sobol`: which parameter spreads the joint angles."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from softfinger.artifacts import save_artifact
from softfinger.artifacts.specs import sobol as sobol_spec
from softfinger.propagation import compute_sobol
from softfinger.stages.forward import open_spread
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
    model: Path | None = None,
) -> None:
    """Write the joint angles' Sobol indices over time."""
    inputs = {"angles": angles, "least_squares": least_squares, "posterior": posterior}
    given, provenance = open_spread("sobol", inputs, config, seed, model)
    save_artifact(compute_sobol(*given), sobol_spec.SPEC, sobol, provenance)
