"""Frames of a video, one at a time."""

import os
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

os.environ.setdefault("OPENCV_FFMPEG_LOGLEVEL", "-8")  # its complaints become our sentences

import cv2
import numpy as np

from softfinger.faults import TrialFault

LARGEST_RATE_ERROR = 0.01
_PLAUSIBLE_COUNT = 10_000_000
_NARROWEST_PX, _LARGEST_PX = 16, 100_000_000
_GREY = cv2.VideoWriter.fourcc(*"Y800")


@dataclass(frozen=True)
class Frame:
    """A picture (row, column, channel) and its time [s]."""

    index: int
    time: float
    picture: np.ndarray


def read_frames(path: Path, fps: float) -> Iterator[Frame]:
    """Read a video frame by frame.

    Memory does not grow with the video's length.

    Times are the container's own time stamps where it has them, else index / rate.

    Parameters
    ----------
    path : Path
        The video.
    fps : float [1/s]
        The declared frame rate.

    Raises
    ------
    TrialFault
        The file is missing, empty, in a format that cannot be decoded, at a frame rate more than
        1 % off the declared one, or cut off.
    """
    capture = _open(path)
    try:
        claimed = capture.get(cv2.CAP_PROP_FRAME_COUNT)
        rate = capture.get(cv2.CAP_PROP_FPS)
        _check_rate(path, rate, fps)
        index = 0
        last = -np.inf
        while True:
            read, picture = capture.read()
            if not read:
                break
            picture = picture[:, :, None] if picture.ndim == 2 else picture
            stamp = capture.get(cv2.CAP_PROP_POS_MSEC) / 1e3
            time = stamp if stamp > last else index / rate
            last = time
            yield Frame(index, time, picture)
            index += 1
    finally:
        capture.release()
    _check_count(path, index, claimed, rate)


def peek_pictures(path: Path, shares: Sequence[float]) -> list[np.ndarray]:
    """Reachable pictures at shares of a video."""
    capture = _open(path)
    pictures = []
    try:
        count = capture.get(cv2.CAP_PROP_FRAME_COUNT)
        for share in shares if 0 < count < _PLAUSIBLE_COUNT else ():
            capture.set(cv2.CAP_PROP_POS_FRAMES, int(share * (count - 1)))
            read, picture = capture.read()
            if read:
                pictures.append(picture[:, :, None] if picture.ndim == 2 else picture)
    finally:
        capture.release()
    return pictures


def _open(path: Path) -> cv2.VideoCapture:
    if not path.is_file():
        raise TrialFault(f"{path.name}: the file {path} does not exist")
    if path.stat().st_size == 0:
        raise TrialFault(f"{path.name}: the file is empty (0 bytes); copy or record it again")
    capture = cv2.VideoCapture(str(path), cv2.CAP_FFMPEG)  # others speak on stderr
    if not capture.isOpened():
        capture.release()
        raise TrialFault(
            f"{path.name}: cannot be decoded; it is cut off, is not a video, or has a codec "
            "that OpenCV does not know; convert it to Motion JPEG or FFV1"
        )
    width, height = (
        int(capture.get(key)) for key in (cv2.CAP_PROP_FRAME_WIDTH, cv2.CAP_PROP_FRAME_HEIGHT)
    )
    if min(width, height) < _NARROWEST_PX or width * height > _LARGEST_PX:
        capture.release()
        raise TrialFault(
            f"{path.name}: its pictures have {width} × {height} px; expected at least "
            f"{_NARROWEST_PX} px on a side and at most {_LARGEST_PX:g} px in all"
        )
    if int(capture.get(cv2.CAP_PROP_CODEC_PIXEL_FORMAT)) == _GREY:
        capture.set(cv2.CAP_PROP_CONVERT_RGB, 0)  # three equal channels would cost a third more
    return capture


def _check_rate(path: Path, rate: float, fps: float) -> None:
    if not np.isfinite(rate) or abs(rate / fps - 1.0) > LARGEST_RATE_ERROR:
        raise TrialFault(
            f"{path.name}: its frame rate is {rate:g} /s, but campaign.yaml declares camera.fps "
            f"{fps:g}; they may differ by at most {100 * LARGEST_RATE_ERROR:g} %"
        )


def _check_count(path: Path, count: int, claimed: float, rate: float) -> None:
    if count == 0:
        raise TrialFault(f"{path.name}: not one frame can be decoded; record it again")
    # Containers without an index (a recorder that was killed) claim nonsense; those that count by
    # duration may be off by one. AVI counts, and a frame that it lost moves all later ones.
    slack = 0 if path.suffix.lower() == ".avi" else 1
    if 0 < claimed < _PLAUSIBLE_COUNT and count < claimed - slack:
        raise TrialFault(
            f"{path.name}: is cut off: {count} frames ({count / rate:.2f} s) of the {claimed:.0f} "
            "that it should have can be decoded; copy or record it again"
        )
