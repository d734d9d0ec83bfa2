"""What is stamped on artifacts, and stages' seeds."""

import hashlib
import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from softfinger.faults import ArtifactFault
from softfinger.provenance.code import code_hash
from softfinger.provenance.environment import environment_hash


@dataclass(frozen=True)
class Provenance:
    """What an artifact is stamped with; no clock."""

    stage: str
    inputs: Mapping[str, str]
    params_sha256: str
    code_sha256: str
    environment_sha256: str
    seed: int | None

    def to_attrs(self) -> dict[str, str | int]:
        """Root attributes of an artifact."""
        attrs = {name: value for name, value in vars(self).items() if value is not None}
        return attrs | {"inputs": json.dumps(dict(self.inputs), sort_keys=True)}


def describe_run(
    stage: str,
    inputs: Mapping[str, Path | str | Sequence[Path | str]],
    params: Mapping[str, Any],
    seed: int | None = None,
) -> Provenance:
    """Provenance of one run of a stage.

    Parameters
    ----------
    stage : str
        Name of the stage, which is the name of its module in ``softfinger.stages``.
    inputs : Mapping
        Role → file or files that were read.
    params : Mapping
        The configuration keys that the stage uses, and only these.
    seed : int
        Root seed of the run, of a stage that draws at random.
    """
    return Provenance(
        stage=stage,
        inputs={role: hash_files(files) for role, files in sorted(inputs.items())},
        params_sha256=_hash_text(json.dumps(params, sort_keys=True, default=str)),
        code_sha256=code_hash(stage),
        environment_sha256=environment_hash(),
        seed=seed,
    )


def _hash_text(text: str) -> str:
    return hashlib.sha256(text.encode()).hexdigest()


def hash_files(files: Path | str | Sequence[Path | str]) -> str:
    """SHA-256 of a file, or of several hashes."""
    if isinstance(files, Path | str):
        if not Path(files).is_file():
            reason = "the file does not exist; run the rule that makes it"
            raise ArtifactFault(str(files), [reason])
        with Path(files).open("rb") as stream:
            return hashlib.file_digest(stream, "sha256").hexdigest()
    return _hash_text("".join(hash_files(file) for file in files))


def derive_seed(seed: int, stage: str) -> int:
    """Seed of a stage's own random stream.

    Examples
    --------
    >>> derive_seed(1, "fit") != derive_seed(1, "track")
    True
    """
    return int(_hash_text(f"{seed} {stage}")[:15], 16)
