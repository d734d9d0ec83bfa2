"""Rule `fit`: the hierarchical posterior."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from softfinger.artifacts import open_artifact, save_tree
from softfinger.artifacts.specs import angles as angles_spec
from softfinger.artifacts.specs import posterior as posterior_spec
from softfinger.inference.posterior import fit_posterior
from softfinger.provenance import derive_seed, describe_run
from softfinger.stages.linear_algebra import on_one_thread
from softfinger.stages.modelled import read_modelled


@on_one_thread
def fit(
    *,
    angles: Path,
    posterior: Path,
    config: Mapping[str, Any],
    cores: int,
    seed: int,
    model: Path | None = None,
) -> None:
    """Write the posterior of a campaign.

    Parameters
    ----------
    cores
        Number of chains that run side by side; no draw depends on it.
    model
        A model file, in place of the base model.
    """
    roles = {"angles": angles} if model is None else {"angles": angles, "model": model}
    provenance = describe_run("fit", roles, config, seed)
    sha256 = provenance.inputs["angles"]
    recorded = open_artifact(angles, angles_spec.SPEC)
    recorded, content, priors = read_modelled(recorded, sha256, model)
    if content and (said := content.describe_origin(sha256)):
        print(said)
    stream = derive_seed(seed, "fit")
    settings = {**config, "cores": cores}
    tree = fit_posterior(recorded, settings, stream, content, priors=priors)
    save_tree(tree, posterior_spec.SPEC, posterior, provenance)
