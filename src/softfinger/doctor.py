"""Checks of this installation, for `softfinger doctor`."""

import shutil
import sys
import tempfile
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import NamedTuple

from softfinger.provenance import INSTALLED, LOCK, PROJECT, list_other_versions

LEAST_PYTHON = (3, 12)
INSTALL = f"pip install -r {LOCK}" if PROJECT == INSTALLED else "make setup"
LEAST_SPACE_GB = 5.0  # a campaign of 100 short videos, with its artifacts


class Finding(NamedTuple):
    """Result of one check, and advice if bad."""

    what: str
    well: bool
    said: str
    advice: str = ""


def check_setup(folder: Path) -> Iterator[Finding]:
    """Check interpreter, packages, film codec, sampler and disk.

    Parameters
    ----------
    folder
        Where results are to be written.
    """
    checks: tuple[Callable[[], Finding], ...] = (
        check_python,
        check_packages,
        check_codec,
        check_sampler,
        lambda: check_folder(folder),
    )
    for check in checks:
        yield check()


def check_python() -> Finding:
    """Python is new enough."""
    said = ".".join(map(str, sys.version_info[:3]))
    advice = f"install Python {LEAST_PYTHON[0]}.{LEAST_PYTHON[1]} or newer, then: {INSTALL}"
    return Finding("Python", sys.version_info[:2] >= LEAST_PYTHON, said, advice)


def check_packages() -> Finding:
    """Packages are those of the lock file."""
    wrong = list_other_versions(LOCK.read_text(encoding="utf-8"), missing=PROJECT != INSTALLED)
    said = "; ".join(wrong) if wrong else "all as in environment.lock"
    return Finding("packages", not wrong, said, f"numbers may differ; install the lock: {INSTALL}")


def check_codec() -> Finding:
    """OpenCV writes and reads the virtual rig's videos."""
    import cv2
    import numpy as np

    with tempfile.TemporaryDirectory() as folder:
        path = f"{folder}/one.avi"
        codec = cv2.VideoWriter.fourcc(*"MJPG")
        writer = cv2.VideoWriter(path, cv2.CAP_FFMPEG, codec, 30.0, (64, 48))
        writer.write(np.full((48, 64, 3), 128, np.uint8))
        writer.release()
        capture = cv2.VideoCapture(path)
        read, picture = capture.read()
        capture.release()
    well = bool(read) and picture.shape == (48, 64, 3)
    said = f"OpenCV {cv2.__version__} {'writes and reads' if well else 'fails on'} Motion JPEG"
    return Finding("video", well, said, f"install opencv-python-headless as locked: {INSTALL}")


def check_sampler() -> Finding:
    """The compiler of the sampler's density compiles."""
    from numba import njit
    from numba.core.errors import NumbaError

    try:
        well = njit(lambda x: x + 1)(1) == 2
        said = "numba compiles"
    except (NumbaError, OSError) as error:
        well, said = False, f"numba fails: {error}"
    return Finding("compiler", well, said, f"install numba as locked: {INSTALL}")


def check_folder(folder: Path) -> Finding:
    """Results can be written, and the disk has room."""
    there = next(place for place in (folder, *folder.absolute().parents) if place.is_dir())
    try:
        with tempfile.TemporaryFile(dir=there):
            free = shutil.disk_usage(there).free / 1e9
    except OSError as error:
        said = f"{there}: {error.strerror}"
        return Finding(
            "disk", False, said, "choose another folder, or ask for permission to write there"
        )
    said = f"{there}: {free:.0f} GB free"
    return Finding("disk", free >= LEAST_SPACE_GB, said, f"make room: {LEAST_SPACE_GB:g} GB")
