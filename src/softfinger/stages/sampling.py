"""Rule `sampling`: whether the sampling can be trusted."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from softfinger.artifacts import open_tree, save_artifact
from softfinger.artifacts.specs import posterior as posterior_spec
from softfinger.artifacts.specs import sampling as sampling_spec
from softfinger.estimation.diagnostics import diagnose_sampling
from softfinger.provenance import describe_run


def sampling(*, posterior: Path, sampling: Path, config: Mapping[str, Any]) -> None:
    """Write a sampling's diagnostics, beside their limits."""
    provenance = describe_run("sampling", {"posterior": posterior}, config)
    tree = open_tree(posterior, posterior_spec.SPEC)
    save_artifact(diagnose_sampling(tree, config), sampling_spec.SPEC, sampling, provenance)
