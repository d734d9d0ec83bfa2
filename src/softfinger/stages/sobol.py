"""Rule `sobol`: which parameter spreads the joint angles."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from softfinger.artifacts import open_artifact, open_tree, save_artifact
from softfinger.artifacts.specs import angles as angles_spec
from softfinger.artifacts.specs import least_squares as least_squares_spec
from softfinger.artifacts.specs import posterior as posterior_spec
from softfinger.artifacts.specs import sobol as sobol_spec
from softfinger.propagation import compute_sobol
from softfinger.provenance import derive_seed, describe_run
from softfinger.stages.forward import open_mover
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
    """Write the joint angles' Sobol indices over time.

    Parameters
    ----------
    model
        The model file that the posterior was fitted with, in place of the base model.
    """
    roles = {"angles": angles, "least_squares": least_squares, "posterior": posterior}
    roles |= {} if model is None else {"model": model}
    provenance = describe_run("sobol", roles, config, seed)
    inputs = (
        open_artifact(angles, angles_spec.SPEC),
        open_artifact(least_squares, least_squares_spec.SPEC),
        open_tree(posterior, posterior_spec.SPEC),
    )
    rng = np.random.default_rng(derive_seed(seed, "sobol"))
    move = open_mover(inputs[0], inputs[2], config, model)
    indices = compute_sobol(*inputs, config, rng, move)
    save_artifact(indices, sobol_spec.SPEC, sobol, provenance)
