"""Rule `check_artifacts`: artifacts against declarations, a receipt."""

import hashlib
from collections.abc import Sequence
from pathlib import Path

from softfinger.artifacts import open_artifact, open_tree, write_atomically
from softfinger.artifacts.specs import list_specs


def check_artifacts(*, artifacts: Sequence[Path], markers: Sequence[Path], receipt: Path) -> None:
    """Open every artifact, and write down its hash."""
    specs = {spec.name: spec for spec in list_specs()}
    named = [(Path(path).stem, Path(path)) for path in artifacts]
    named += [("markers", Path(path)) for path in markers]
    rows = ["artifact,file,sha256"]
    for name, path in named:
        open_one = open_tree if specs[name].groups else open_artifact
        open_one(path, specs[name])
        digest = hashlib.sha256(path.read_bytes()).hexdigest()
        rows.append(f"{name},{path.name},{digest}")
    with write_atomically(receipt) as temporary:
        temporary.write_text("\n".join(rows) + "\n", encoding="utf-8")
