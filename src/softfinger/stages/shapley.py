"""Rule `shapley`: shares of correlated parameters."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from softfinger.artifacts import save_artifact
from softfinger.artifacts.specs import shapley as shapley_spec
from softfinger.propagation import compute_shapley
from softfinger.stages.forward import open_spread
from softfinger.stages.linear_algebra import on_one_thread


@on_one_thread
def shapley(
    *,
    angles: Path,
    posterior: Path,
    shapley: Path,
    config: Mapping[str, Any],
    seed: int,
    model: Path | None = None,
) -> None:
    """Write Shapley effects over time, and parameter correlations."""
    inputs = {"angles": angles, "posterior": posterior}
    given, provenance = open_spread("shapley", inputs, config, seed, model)
    save_artifact(compute_shapley(*given), shapley_spec.SPEC, shapley, provenance)
