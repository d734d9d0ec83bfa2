"""Where a result comes from.

It is given by hashes of inputs, parameters, environment and the code it used.

Nothing heavy is imported, because every parse of the workflow imports this package.
"""

from softfinger.provenance.code import PACKAGE, PROJECT, code_hash, find_modules
from softfinger.provenance.run import (
    Provenance,
    derive_seed,
    describe_run,
    environment_hash,
    hash_files,
)

__all__ = [
    "PACKAGE",
    "PROJECT",
    "Provenance",
    "code_hash",
    "derive_seed",
    "describe_run",
    "environment_hash",
    "find_modules",
    "hash_files",
]
