"""A camera that films the simulated finger.

The simulator sends one small record per exposure, on a TCP port of this machine; the picture is
made where it is wanted, by the virtual rig's renderer. Exposures are at exact camera times however
late the record is sent, so a busy machine delays pictures but does not spoil them.
"""

import contextlib
import math
import socket
import struct

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from softfinger.faults import Fault
from softfinger.rig.finger import build_finger_config
from softfinger.virtual_rig.render import (
    build_canvas,
    build_noise_table,
    draw_finger,
    expose_array,
)
from softfinger.virtual_rig.scene import (
    FRAME_HEIGHT_PX,
    FRAME_WIDTH_PX,
    compute_base_capsule,
    compute_capsules,
    compute_marker_position,
)

CAMERA_AHEAD_S = 1000.25  # the camera's clock started earlier than the controller's
SYNC_LIGHT_PX = (24, 24, 16, 16)  # x, y, width, height
LIGHT_GREY = 250
_EXPOSURE = struct.Struct("<QdB3d")  # frame, stamp [s], light, joint angles [rad]
_MOST_WAITING_BYTES = 4_000_000


class ExposureFeed:
    """The simulator's end: sends each frame's finger state."""

    def __init__(self, fps: float) -> None:
        self.fps = fps
        self._listener = socket.create_server(("127.0.0.1", 0))
        self._listener.setblocking(False)
        self._viewer: socket.socket | None = None
        self._waiting = bytearray()
        self._next_frame = 0

    @property
    def name(self) -> str:
        """What to call the camera when recording from it."""
        return f"virtual:{self._listener.getsockname()[1]}"

    def list_due_frames(self, now: float) -> range:
        """Frames k due at k / fps, if watched."""
        self._accept(now)
        last = math.floor(now * self.fps)
        due = range(self._next_frame, last + 1) if self._viewer else range(0)
        self._next_frame = max(self._next_frame, last + 1)
        return due

    def send(self, frame: int, light: bool, angle: NDArray[np.float64]) -> None:
        """Send a frame; a slow viewer loses it."""
        if len(self._waiting) < _MOST_WAITING_BYTES:
            stamp = frame / self.fps + CAMERA_AHEAD_S
            self._waiting += _EXPOSURE.pack(frame, stamp, int(light), *angle)
        self.flush()

    def flush(self) -> None:
        """Send what the viewer takes without waiting for it."""
        if self._viewer is None or not self._waiting:
            return
        try:
            del self._waiting[: self._viewer.send(self._waiting)]
        except BlockingIOError:
            return
        except OSError:
            self.hang_up()

    def hang_up(self) -> None:
        """End the connection to the viewer."""
        if self._viewer is not None:
            self._viewer.close()
        self._viewer, self._waiting = None, bytearray()

    def close(self) -> None:
        """End the service."""
        self.hang_up()
        self._listener.close()

    def _accept(self, now: float) -> None:
        try:
            viewer = self._listener.accept()[0]
        except BlockingIOError:
            return
        self.hang_up()
        viewer.setblocking(False)
        self._viewer, self._next_frame = viewer, math.floor(now * self.fps) + 1


class VirtualCamera:
    """The recorder's end: a camera like any other."""

    def __init__(self, port: int, timeout: float) -> None:
        self._name = f"virtual:{port}"
        try:
            self._socket = socket.create_connection(("127.0.0.1", port), timeout=timeout)
        except OSError as error:
            raise Fault(
                f"camera {self._name}: no simulator answers there ({error}); give the name that "
                "`softfinger rig simulate` printed"
            ) from None
        self._config = build_finger_config()
        self._canvas = build_canvas(self._config, compute_base_capsule(self._config))
        self._noise = build_noise_table(self._config.camera_noise_grey)
        self._picture = np.empty_like(self._canvas.still)
        self._render(0, False, np.zeros(3))  # compiles now what must not wait later

    def read(self) -> tuple[float, NDArray[np.uint8]]:
        """Wait for the next frame.

        Returns its stamp [s] and picture (row, column).

        Raises
        ------
        Fault
            The camera is gone, or silent for its timeout.
        """
        record = b""
        while len(record) < _EXPOSURE.size:
            try:
                received = self._socket.recv(_EXPOSURE.size - len(record))
            except OSError as error:
                raise Fault(f"camera {self._name} sends no picture any more ({error})") from None
            if not received:
                raise Fault(f"camera {self._name} is gone: it ended the connection")
            record += received
        frame, stamp, light, *angle = _EXPOSURE.unpack(record)
        return stamp, self._render(frame, bool(light), np.array(angle))

    def close(self) -> None:
        """Hang up; a waiting `read` ends."""
        with contextlib.suppress(OSError):  # the other end was faster
            self._socket.shutdown(socket.SHUT_RDWR)
        self._socket.close()

    def _render(self, frame: int, light: bool, angle: NDArray) -> NDArray[np.uint8]:
        self._picture[:] = self._canvas.still
        marks = compute_marker_position(xr.DataArray(angle, dims="joint"), self._config).values
        capsules = compute_capsules(angle[None], self._config)[0]
        draw_finger(self._picture, self._canvas, capsules, marks)
        exposed = np.empty((FRAME_HEIGHT_PX, FRAME_WIDTH_PX), np.uint8)
        key = np.random.SeedSequence(frame).generate_state(1, np.uint64)[0]
        expose_array(self._picture, self._noise, key, exposed)
        if light:
            x, y, width, height = SYNC_LIGHT_PX
            exposed[y : y + height, x : x + width] = LIGHT_GREY
        return exposed
