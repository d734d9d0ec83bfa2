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
from softfinger.provenance import derive_seed, describe_run
from softfinger.stages.linear_algebra import on_one_thread


@on_one_thread
def fit(
    *, angles: Path, posterior: Path, sampling: Path, config: Mapping[str, Any], seed: int
) -> None:
    """Write the posterior of a campaign and the diagnostics of its sampling."""
    provenance = describe_run("fit", {"angles": angles}, config, seed)
    recorded = open_artifact(angles, angles_spec.SPEC)
    tree = fit_posterior(recorded, config, derive_seed(seed, "fit"))
    save_tree(tree, posterior_spec.SPEC, posterior, provenance)
    save_artifact(diagnose_sampling(tree, config), sampling_spec.SPEC, sampling, provenance)
