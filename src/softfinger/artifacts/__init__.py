"""NetCDF artifacts: what each one holds, how it is saved, and what is refused at the door."""

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
