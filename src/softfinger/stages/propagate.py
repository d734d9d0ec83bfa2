"""Rule `propagate`: from parameters' to angles' spread."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from softfinger.artifacts import open_artifact, open_tree, save_artifact
from softfinger.artifacts.specs import angles as angles_spec
from softfinger.artifacts.specs import bands as bands_spec
from softfinger.artifacts.specs import densities as densities_spec
from softfinger.artifacts.specs import least_squares as least_squares_spec
from softfinger.artifacts.specs import posterior as posterior_spec
from softfinger.propagation import compute_bands, compute_densities
from softfinger.provenance import derive_seed, describe_run
from softfinger.stages.forward import open_mover
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
    """Write bands and densities of the joint angles.

    Parameters
    ----------
    model
        The model file that the posterior was fitted with, in place of the base model.
    """
    roles = {"angles": angles, "least_squares": least_squares, "posterior": posterior}
    roles |= {} if model is None else {"model": model}
    provenance = describe_run("propagate", roles, config, seed)
    inputs = (
        open_artifact(angles, angles_spec.SPEC),
        open_artifact(least_squares, least_squares_spec.SPEC),
        open_tree(posterior, posterior_spec.SPEC),
    )
    rng = np.random.default_rng(derive_seed(seed, "propagate"))
    move = open_mover(inputs[0], inputs[2], config, model)
    save_artifact(compute_bands(*inputs, config, rng, move), bands_spec.SPEC, bands, provenance)
    found = compute_densities(*inputs, config, rng, move)
    save_artifact(found, densities_spec.SPEC, densities, provenance)
