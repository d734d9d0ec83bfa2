"""Rule `propagate`: from parameters' to angles' spread."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from softfinger.artifacts import save_artifact
from softfinger.artifacts.specs import bands as bands_spec
from softfinger.artifacts.specs import densities as densities_spec
from softfinger.propagation import compute_bands, compute_densities
from softfinger.stages.forward import open_spread
from softfinger.stages.linear_algebra import on_one_thread


@on_one_thread
def propagate(
    *,
    angles: Path,
    least_squares: Path,
    posterior: Path,
    bands: Path,
    densities: Path,
    config: Mapping[str, Any],
    seed: int,
    model: Path | None = None,
) -> None:
    """Write bands and densities of the joint angles."""
    inputs = {"angles": angles, "least_squares": least_squares, "posterior": posterior}
    given, provenance = open_spread("propagate", inputs, config, seed, model)
    save_artifact(compute_bands(*given), bands_spec.SPEC, bands, provenance)
    save_artifact(compute_densities(*given), densities_spec.SPEC, densities, provenance)
