"""Recordings with the same name, link or content."""

import hashlib
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path

from softfinger.doubts.doubt import Doubt
from softfinger.faults import list_briefly

BLOCK = 1 << 20


def doubt_files(recordings: Mapping[str, Path]) -> Iterator[Doubt]:
    """Doubt trials with the same file or content.

    The argument is name → recording.

    Only files of equal size are read.
    """
    for same_size in _group(recordings, lambda path: path.stat().st_size):
        for names in _group({name: recordings[name] for name in same_size}, _hash):
            yield Doubt(
                "equal_files",
                f"the recordings of trials {list_briefly(names)} have the same content "
                f"({', '.join(sorted({recordings[name].name for name in names}))}); likely one "
                "file that was named or copied twice; give each trial its own recording",
                tuple(names),
            )


def _group(recordings: Mapping[str, Path], key: Callable[[Path], object]) -> list[list[str]]:
    groups: dict[object, list[str]] = {}
    for name, path in recordings.items():
        groups.setdefault(key(path), []).append(name)
    return [names for names in groups.values() if len(names) > 1]


def _hash(path: Path) -> str:
    digest = hashlib.sha256()
    with path.open("rb") as stream:
        while block := stream.read(BLOCK):
            digest.update(block)
    return digest.hexdigest()
