"""Pictures of videos and files, decoded where they can do no harm."""

import os
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

import numpy as np

from softfinger.faults import Fault
from softfinger.gate.child import Message

if TYPE_CHECKING:
    import cv2

NARROWEST_PX, LARGEST_PX = 16, 100_000_000
MOST_THREADS = 4
CONTAINERS = "avi,matroska,mov,mpegts,mpeg,asf,ogg,flv,mjpeg,h264,hevc,m4v,dv,mxf,gif"
"""FFmpeg's readers of one file. Others follow addresses in a text: playlists, streams."""
FRAME_HEADERS = frozenset(range(0xC0, 0xD0)) - {0xC4, 0xC8, 0xCC}
"""Markers of a JPEG's segment that contains its size."""
OPTIONS = f"protocol_whitelist;file|format_whitelist;{CONTAINERS}"


def decode_video(path: str, shares: Sequence[float] | None = None) -> Iterator[Message]:
    """Decode a video's pictures.

    Parameters
    ----------
    path
    shares
        Decode only pictures at these shares of its length, as far as they can be reached.

    Yields
    ------
    First what the container claims: ``frames``, ``rate [1/s]``, and no bytes. Then of each frame
    ``shape`` and ``stamp [s]``, and its bytes (row, column, channel).

    Raises
    ------
    Fault
        It cannot be decoded, or its pictures have a size that no camera's have, or two sizes.
    """
    import cv2

    os.environ["OPENCV_FFMPEG_CAPTURE_OPTIONS"] = OPTIONS
    threads = min(MOST_THREADS, os.cpu_count() or 1)
    capture = cv2.VideoCapture(path, cv2.CAP_FFMPEG, [cv2.CAP_PROP_N_THREADS, threads])
    if not capture.isOpened():
        raise Fault(
            "cannot be decoded; it is cut off, is not a video, or has a codec that OpenCV does not "
            "know; convert it to Motion JPEG or FFV1"
        )
    size = [int(capture.get(k)) for k in (cv2.CAP_PROP_FRAME_HEIGHT, cv2.CAP_PROP_FRAME_WIDTH)]
    _check_size(size)
    if int(capture.get(cv2.CAP_PROP_CODEC_PIXEL_FORMAT)) == cv2.VideoWriter.fourcc(*"Y800"):
        capture.set(cv2.CAP_PROP_CONVERT_RGB, 0)  # three equal channels would cost a third more
    claimed, rate = (capture.get(k) for k in (cv2.CAP_PROP_FRAME_COUNT, cv2.CAP_PROP_FPS))
    yield {"frames": claimed, "rate": rate}, np.empty(0, np.uint8)
    if shares is None:
        yield from _decode_all(capture, _read_own_sizes(path, capture))
    for share in shares or ():
        capture.set(cv2.CAP_PROP_POS_FRAMES, int(share * (claimed - 1)))
        read, picture = capture.read()
        if read:
            yield _describe(picture), picture


def _decode_all(
    capture: "cv2.VideoCapture", own_sizes: Iterator[tuple[int, int] | None]
) -> Iterator[Message]:
    """Every frame; OpenCV scales one of another size to the first."""
    import cv2

    size = next(own_sizes, None)
    while (read := capture.read())[0]:
        picture, own = read[1], next(own_sizes, None)
        if own and size and own != size:
            raise Fault(
                f"a picture has {own[1]} × {own[0]} px, and those before it {size[1]} × {size[0]} "
                "px; expected one size; record it again, or convert it to one size"
            )
        yield _describe(picture) | {"stamp": capture.get(cv2.CAP_PROP_POS_MSEC) / 1e3}, picture


def _read_own_sizes(path: str, capture: "cv2.VideoCapture") -> Iterator[tuple[int, int] | None]:
    """Sizes (height, width) that coded pictures have, the first twice.

    Only those of Motion JPEG have one each.
    """
    import cv2

    if int(capture.get(cv2.CAP_PROP_FOURCC)) != cv2.VideoWriter.fourcc(*"MJPG"):
        return
    packets = cv2.VideoCapture(path, cv2.CAP_FFMPEG, [cv2.CAP_PROP_FORMAT, -1])
    first = True
    while (read := packets.read())[0]:
        own = find_jpeg_size(read[1].tobytes())
        yield from [own] * (1 + first)
        first = False


def find_jpeg_size(coded: bytes) -> tuple[int, int] | None:
    """Height and width in a JPEG's header, None where it has none.

    >>> find_jpeg_size(bytes.fromhex("ffd8 ffc0 0011 08 0030 0042 03"))
    (48, 66)
    """
    at = 2
    while coded[at : at + 1] == b"\xff" and at + 9 <= len(coded):
        kind, length = coded[at + 1], int.from_bytes(coded[at + 2 : at + 4])
        if kind in FRAME_HEADERS:
            return int.from_bytes(coded[at + 5 : at + 7]), int.from_bytes(coded[at + 7 : at + 9])
        at += 2 + length
    return None


def decode_picture(path: str) -> Iterator[Message]:
    """Decode one picture in grey; nothing where it is none."""
    import cv2

    picture = cv2.imread(path, cv2.IMREAD_GRAYSCALE)
    if picture is not None:
        _check_size(picture.shape)
        yield _describe(picture), picture


def _describe(picture: np.ndarray) -> dict:
    return {"shape": (*picture.shape, 1)[:3]}


def _check_size(size: Sequence[int]) -> None:
    height, width = size
    if min(width, height) < NARROWEST_PX or width * height > LARGEST_PX:
        raise Fault(
            f"its pictures have {width} × {height} px; expected at least {NARROWEST_PX} px on a "
            f"side and at most {LARGEST_PX:g} px in all"
        )
