"""One declared artifact per file; a rule depends only on the ones that it reads or writes."""

from __future__ import annotations

import importlib
import pkgutil

from softfinger.artifacts.spec import ArtifactSpec


def list_specs() -> list[ArtifactSpec]:
    """Every declared artifact, by name; for documentation and tests, used by no stage."""
    names = sorted(module.name for module in pkgutil.iter_modules(__path__))
    return [importlib.import_module(f"{__name__}.{name}").SPEC for name in names]
