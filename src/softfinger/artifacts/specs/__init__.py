"""One declared artifact per file.

A rule depends only on those that it reads or writes.
"""

import importlib
import pkgutil

from softfinger.artifacts.spec import ArtifactSpec


def list_specs() -> list[ArtifactSpec]:
    """Every declared artifact, by name.

    Documentation and tests use it; no stage does.
    """
    names = sorted(module.name for module in pkgutil.iter_modules(__path__))
    return [importlib.import_module(f"{__name__}.{name}").SPEC for name in names]
