"""The sentence that a failing program ends with."""

import errno
import os
import platform
import sys
import tempfile
import time
import traceback
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

from softfinger.faults import Fault, make_printable

PACKAGES = ("softfinger", "numpy", "scipy", "numba", "pandas", "xarray", "pymc", "snakemake")
ADVICE = {
    errno.ENOSPC: "make room, or choose another folder",
    errno.EDQUOT: "make room, or choose another folder",
    errno.EROFS: "choose a folder that can be written",
    errno.EACCES: "ask for permission, or choose another place",
    errno.EPERM: "ask for permission, or choose another place",
    errno.EISDIR: "it is a folder where a file is expected; choose another name",
    errno.ENOTDIR: "a part of its path is a file; choose another name",
    errno.EEXIST: "a file is where a folder is expected; choose another name",
    errno.ENOENT: "check the path",
    errno.ENAMETOOLONG: "choose a shorter name",
}
DEGENERATE = (
    "; the recordings may be degenerate (no noise, equal joints, extreme numbers): run "
    "`softfinger check`"
)


def describe_failure(error: Exception) -> str:
    """One sentence on what ended a program.

    A fault of the input or of the disk is described by what to do. Anything else is unexpected:
    its traceback and the versions go into a file, in the working folder or else the temporary one,
    and the sentence names that file.
    """
    if isinstance(error, Fault):
        return str(error)
    if isinstance(error, OSError) and error.errno is not None:
        # Names of some errors come without a file: standard output that is full.
        place = make_printable(str(error.filename or "output"))[:300]
        return f"{place}: {error.strerror}; {ADVICE.get(error.errno, 'choose another place')}"
    kind = type(error).__name__
    said = make_printable(" ".join(str(error).split()))[:300]
    if isinstance(error, MemoryError):
        return f"not enough memory ({said or kind}); use fewer trials or frames, or more memory"
    hint = DEGENERATE if isinstance(error, ArithmeticError | ValueError) else ""
    file = write_failure_report(error)
    where = f"please send {file}" if file else "no report of it could be written"
    return f"an unexpected error, {kind}: {said}{hint}; {where}"


def write_failure_report(error: Exception) -> Path | None:
    """Write an unexpected error's report; None without folder."""
    text = "\n".join(
        [
            "softfinger ended with an unexpected error. Please send this file to its developers,",
            "and the campaign if you may: campaign.yaml, trials.csv and one trial often suffice.",
            "",
            f"command: {' '.join(sys.argv)}",
            f"python: {platform.python_version()} on {platform.platform()}",
            *(f"{name}: {_find_version(name)}" for name in PACKAGES),
            "",
            *(line.rstrip("\n") for line in traceback.format_exception(error)),
        ]
    )
    name = f"softfinger-error-{time.strftime('%Y%m%d-%H%M%S')}-{os.getpid()}.txt"
    for folder in (Path.cwd, lambda: Path(tempfile.gettempdir())):
        try:
            file = folder() / name
            file.write_text(text + "\n", encoding="utf-8", errors="backslashreplace")
        except OSError:
            continue
        return file
    return None


def _find_version(name: str) -> str:
    try:
        return version(name)
    except PackageNotFoundError:
        return "absent"
