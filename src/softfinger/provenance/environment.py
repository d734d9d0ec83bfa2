"""The installed libraries, beside the locked ones."""

import hashlib
import re
from functools import cache
from importlib.metadata import PackageNotFoundError, version

from softfinger.provenance.code import PROJECT

LOCK = PROJECT / "environment.lock"
_PIN = re.compile(r"^([A-Za-z0-9_.-]+)==([^ ;\\]+)( ;[^\\]*)?", re.MULTILINE)


@cache
def environment_hash() -> str:
    """SHA-256 of ``environment.lock``, and of what differs from it.

    An installation from a wheel may have other versions than the lock; then its hash is another.
    """
    lock = LOCK.read_text(encoding="utf-8")
    differing = [f"{line}\n" for line in list_other_versions(lock, missing=False)]
    return hashlib.sha256("".join([lock, *differing]).encode()).hexdigest()


def list_other_versions(lock: str, *, missing: bool = True) -> list[str]:
    """Packages whose version differs from the lock file's.

    A package that the lock names under a condition (``; sys_platform == …``) may be missing; with
    `missing` false any may, such as those that only developers need.

    Examples
    --------
    >>> list_other_versions("numpy==0.1 --hash=sha256:00")  # doctest: +ELLIPSIS
    ['numpy ... instead of 0.1']
    >>> list_other_versions("no-such-package==1 ; python_version < '3'")
    []
    """
    pins: dict[str, dict[str, str]] = {}  # a lock for several Pythons may pin a package twice
    for name, pinned, condition in _PIN.findall(lock):
        pins.setdefault(name, {})[pinned] = condition
    wrong = []
    for name, allowed in pins.items():
        try:
            found = version(name)
        except PackageNotFoundError:
            if missing and not all(allowed.values()):
                wrong.append(f"{name} is missing")
            continue
        if found not in allowed:
            wrong.append(f"{name} {found} instead of {' or '.join(allowed)}")
    return wrong
