"""A checksum at the end of every artifact.

A file with a flipped bit is refused before anything is read.

NetCDF does not notice a flipped bit in a number, and HDF5 may loop for ever on one in its
structure. Whatever follows the end of an HDF5 file is ignored by all that read such files, so the
checksum of all before it is appended there: `softfinger sha256 ` and 64 hexadecimal digits.
"""

import hashlib
from pathlib import Path

MARK = b"\nsoftfinger sha256 "
LENGTH = len(MARK) + 64
BLOCK = 1 << 20


def append_checksum(path: Path) -> None:
    """Append the checksum of a file to it."""
    digest = _hash_start(path, path.stat().st_size)
    with path.open("ab") as stream:
        stream.write(MARK + digest)


def is_whole(path: Path) -> bool:
    """Whether a file ends in its own checksum."""
    start = path.stat().st_size - LENGTH
    if start < 0:
        return False
    with path.open("rb") as stream:
        stream.seek(start)
        end = stream.read()
    return end == MARK + _hash_start(path, start)


def _hash_start(path: Path, size: int) -> bytes:
    digest = hashlib.sha256()
    with path.open("rb") as stream:
        while size > 0 and (block := stream.read(min(size, BLOCK))):
            digest.update(block)
            size -= len(block)
    return digest.hexdigest().encode()
