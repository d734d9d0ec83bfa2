"""Cameras, real and virtual, behind one thread."""

import os
import threading
import time
from collections import deque
from typing import NamedTuple, Protocol, Self

os.environ.setdefault("OPENCV_FFMPEG_LOGLEVEL", "-8")  # its complaints become our sentences

import cv2
import numpy as np
from numpy.typing import NDArray

from softfinger.faults import Fault
from softfinger.rig.plan import Plan
from softfinger.rig.virtual_camera import VirtualCamera


class PictureSource(Protocol):
    """What takes pictures."""

    def read(self) -> tuple[float, NDArray[np.uint8]]:
        """Wait for a frame: its stamp [s], picture."""

    def close(self) -> None:
        """End it."""


class StampedPicture(NamedTuple):
    """Stamp [s], sync light's mean grey, picture as JPEG."""

    stamp: float
    brightness: float
    jpeg: bytes


class OpenCvCamera:
    """A camera that OpenCV opens, by number or path.

    The stamp is the driver's where the first frame has one, else the moment of arrival: either will
    do, because the sync light ties it to the controller's clock, but never a mixture.
    """

    def __init__(self, name: str, fps: float, width: int, height: int) -> None:
        self._name = name
        self._capture = cv2.VideoCapture(int(name) if name.isdecimal() else name)
        if not self._capture.isOpened():
            raise Fault(
                f"camera {name} cannot be opened; is it plugged in, and free of other programs?"
            )
        self._capture.set(cv2.CAP_PROP_FRAME_WIDTH, width)
        self._capture.set(cv2.CAP_PROP_FRAME_HEIGHT, height)
        self._capture.set(cv2.CAP_PROP_FPS, fps)
        self._stamped: bool | None = None

    def read(self) -> tuple[float, NDArray[np.uint8]]:
        """Wait for the next frame.

        Returns its stamp [s] and picture (row, column, channel).

        Raises
        ------
        Fault
            The camera gives no picture any more.
        """
        seen, picture = self._capture.read()
        arrived = time.monotonic()
        if not seen:
            raise Fault(f"camera {self._name} sends no picture any more; check its cable")
        stamp = self._capture.get(cv2.CAP_PROP_POS_MSEC) / 1e3
        if self._stamped is None:
            self._stamped = stamp > 0
        return stamp if self._stamped else arrived, picture

    def close(self) -> None:
        """Give the camera back."""
        self._capture.release()


def open_camera(name: str, plan: Plan) -> PictureSource:
    """Open a camera, real or virtual.

    A number or path is for OpenCV, ``virtual:PORT`` for a simulator.

    Raises
    ------
    Fault
        There is no such camera.
    """
    kind, _, port = name.partition(":")
    if kind == "virtual" and port.isdecimal():
        return VirtualCamera(int(port), plan.safety.camera_timeout_s)
    return OpenCvCamera(name, plan.fps, *plan.recording.picture_px)


class FrameGrabber:
    """Takes every frame of a camera inside its context."""

    def __init__(self, camera: PictureSource, plan: Plan) -> None:
        self._camera = camera
        self._size = plan.recording.picture_px
        self._light = plan.recording.sync_light_px
        self._quality = plan.recording.video_quality
        self._timeout = plan.safety.camera_timeout_s
        self._frames: deque[StampedPicture] = deque()
        self._failure: Exception | None = None
        self._ended = threading.Event()
        self._last_arrival = time.monotonic()
        self._thread = threading.Thread(target=self._grab, name="camera", daemon=True)

    def __enter__(self) -> Self:
        """Begin."""
        self._last_arrival = time.monotonic()
        self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        """End, and close the camera."""
        self._ended.set()
        self._thread.join(self._timeout)
        self._camera.close()

    def take(self) -> list[StampedPicture]:
        """Return the frames since the last time.

        Raises
        ------
        Fault
            The camera has failed, or is silent for longer than its timeout.
        """
        failure = self._failure  # looked at first: frames taken before it are still handed out
        taken = []
        while self._frames:
            taken.append(self._frames.popleft())
        now = time.monotonic()
        if taken:
            self._last_arrival = now
        elif failure is not None:
            raise failure
        elif now - self._last_arrival > self._timeout:
            raise Fault(
                f"the camera has sent no picture for {self._timeout:g} s; check its cable, and "
                "whether the computer is too busy"
            )
        return taken

    def _grab(self) -> None:
        try:
            while not self._ended.is_set():
                self._frames.append(self._describe(*self._camera.read()))
        except Exception as failure:  # handed over to the thread that asks
            self._failure = failure

    def _describe(self, stamp: float, picture: NDArray[np.uint8]) -> StampedPicture:
        if picture.shape[1::-1] != self._size:
            raise Fault(
                f"the camera takes pictures of {picture.shape[1]} × {picture.shape[0]} px, but "
                f"recording.picture_px is {list(self._size)}; name a size that it has"
            )
        x, y, width, height = self._light
        place = picture[y : y + height, x : x + width]
        jpeg = cv2.imencode(".jpg", picture, [cv2.IMWRITE_JPEG_QUALITY, self._quality])[1]
        return StampedPicture(stamp, float(place.mean()), jpeg.tobytes())
