"""Rule `fit`: the hierarchical posterior, and whether its sampling can be trusted."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from softfinger.artifacts import open_artifact, save_artifact, save_tree
from softfinger.artifacts.specs import angles as angles_spec
from softfinger.artifacts.specs import posterior as posterior_spec
from softfinger.artifacts.specs import sampling as sampling_spec
from softfinger.estimation import diagnose_sampling, fit_posterior
from softfinger.mechanics.effects.model_file import read_model_file
from softfinger.mismatch.fit import fit_effects
from softfinger.provenance import derive_seed, describe_run
from softfinger.stages.linear_algebra import on_one_thread


@on_one_thread
def fit(
    *,
    angles: Path,
    posterior: Path,
    sampling: Path,
    config: Mapping[str, Any],
    seed: int,
    model: Path | None = None,
) -> None:
    """Write the posterior of a campaign and the diagnostics of its sampling.

    Parameters
    ----------
    model
        A model file, in place of the base model.
    """
    roles = {"angles": angles} if model is None else {"angles": angles, "model": model}
    provenance = describe_run("fit", roles, config, seed)
    recorded = open_artifact(angles, angles_spec.SPEC)
    stream = derive_seed(seed, "fit")
    if model is None:
        tree = fit_posterior(recorded, config, stream)
    else:
        content = read_model_file(model)
        priors = not content.was_fitted_to(provenance.inputs["angles"])
        tree = fit_effects(recorded, content, config, stream, priors=priors)
    save_tree(tree, posterior_spec.SPEC, posterior, provenance)
    save_artifact(diagnose_sampling(tree, config), sampling_spec.SPEC, sampling, provenance)
