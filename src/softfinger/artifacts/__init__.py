"""NetCDF artifacts: content, saving, and refused files."""

from softfinger.artifacts.spec import ArtifactSpec, Variable, list_faults
from softfinger.artifacts.store import (
    open_artifact,
    open_tree,
    save_artifact,
    save_tree,
    write_atomically,
)

__all__ = [
    "ArtifactSpec",
    "Variable",
    "list_faults",
    "open_artifact",
    "open_tree",
    "save_artifact",
    "save_tree",
    "write_atomically",
]
