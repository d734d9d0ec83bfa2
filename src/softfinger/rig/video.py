"""Motion-JPEG videos of frames that are compressed already."""

import os
from collections.abc import Sequence
from pathlib import Path

os.environ.setdefault("OPENCV_FFMPEG_LOGLEVEL", "-8")

import cv2
import numpy as np


def write_video(path: Path, pictures: Sequence[bytes], rate: float) -> None:
    """Write JPEG pictures to an ``.avi`` and verify it.

    All pictures have one size.

    Parameters
    ----------
    path
        Written in place; give a temporary name.
    pictures
        One per frame of the video.
    rate
        [1/s]

    Raises
    ------
    OSError
        Not every frame can be read again, as on a full disk.
    """
    first = cv2.imdecode(np.frombuffer(pictures[0], np.uint8), cv2.IMREAD_UNCHANGED)
    writer = cv2.VideoWriter(
        str(path),
        cv2.CAP_FFMPEG,
        cv2.VideoWriter.fourcc(*"MJPG"),
        rate,
        (first.shape[1], first.shape[0]),
        [cv2.VIDEOWRITER_PROP_RAW_VIDEO, 1, cv2.VIDEOWRITER_PROP_IS_COLOR, int(first.ndim == 3)],
    )
    if writer.isOpened():
        for picture in pictures:
            if not writer.write(np.frombuffer(picture, np.uint8).reshape(1, -1)):
                break
    writer.release()
    readable = count_frames(path)
    if readable < len(pictures):
        raise OSError(f"of {len(pictures)} frames {readable} can be read again; is the disk full?")


def count_frames(path: Path) -> int:
    """Number of frames that decode, whatever is claimed."""
    capture = cv2.VideoCapture(str(path))
    count = 0
    while capture.grab():
        count += 1
    capture.release()
    return count
