"""Where a result comes from.

It is given by hashes of inputs, parameters, environment and the code it used.

Nothing heavy is imported, because every parse of the workflow imports this package.
"""

from softfinger.provenance.code import INSTALLED, PACKAGE, PROJECT, code_hash, find_modules
from softfinger.provenance.environment import LOCK, environment_hash, list_other_versions
from softfinger.provenance.run import (
    Provenance,
    derive_seed,
    describe_run,
    hash_files,
)

__all__ = [
    "INSTALLED",
    "LOCK",
    "PACKAGE",
    "PROJECT",
    "Provenance",
    "code_hash",
    "derive_seed",
    "describe_run",
    "environment_hash",
    "find_modules",
    "hash_files",
    "list_other_versions",
]
