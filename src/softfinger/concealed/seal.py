"""Seals an answer before the question is put."""

import hashlib
import json
import secrets
from pathlib import Path


def make_salt() -> str:
    """Sixty-four random hexadecimal digits, against guessing."""
    return secrets.token_hex(32)


def seal(truth: bytes, salt: str) -> str:
    """SHA-256 of the truth followed by the salt.

    Examples
    --------
    >>> seal(b"", "")[:16]
    'e3b0c44298fc1c14'
    """
    return hashlib.sha256(truth + salt.encode()).hexdigest()


def seal_file(truth_path: Path, salt_path: Path) -> str:
    """Seal a file beside its salt; its digest."""
    salt = make_salt()
    salt_path.write_text(salt + "\n", encoding="utf-8")
    return seal(truth_path.read_bytes(), salt)


def open_seal(truth_path: Path, salt_path: Path, digest: str) -> dict:
    """The truth, if its seal is intact.

    Raises
    ------
    ValueError
        Truth or salt were changed after the digest was shown.
    """
    truth = truth_path.read_bytes()
    found = seal(truth, salt_path.read_text(encoding="utf-8").strip())
    if found != digest:
        raise ValueError(
            f"{truth_path}: its seal is broken: the digest is {found[:16]}…, but {digest[:16]}… "
            "was shown before the diagnosis; the truth or its salt was changed"
        )
    return json.loads(truth)
