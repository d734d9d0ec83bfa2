"""Rule `shapley`: shares of correlated parameters."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from softfinger.artifacts import open_artifact, open_tree, save_artifact
from softfinger.artifacts.specs import angles as angles_spec
from softfinger.artifacts.specs import posterior as posterior_spec
from softfinger.artifacts.specs import shapley as shapley_spec
from softfinger.propagation import compute_shapley
from softfinger.provenance import derive_seed, describe_run
from softfinger.stages.forward import open_mover
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
    """Write Shapley effects over time, and parameter correlations.

    Parameters
    ----------
    model
        The model file that the posterior was fitted with, in place of the base model.
    """
    roles = {"angles": angles, "posterior": posterior}
    roles |= {} if model is None else {"model": model}
    provenance = describe_run("shapley", roles, config, seed)
    inputs = open_artifact(angles, angles_spec.SPEC), open_tree(posterior, posterior_spec.SPEC)
    rng = np.random.default_rng(derive_seed(seed, "shapley"))
    move = open_mover(*inputs, config, model)
    effects = compute_shapley(*inputs, config, rng, move)
    save_artifact(effects, shapley_spec.SPEC, shapley, provenance)
