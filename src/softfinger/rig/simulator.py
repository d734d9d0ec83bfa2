"""A simulated rig: controller and finger on a pseudo-terminal."""

import bisect
import contextlib
import errno
import os
import select
import time
import tty
from pathlib import Path
from typing import TextIO

import numpy as np

from softfinger.rig.device import Device, DeviceSettings
from softfinger.rig.finger import VirtualFinger, build_finger_config
from softfinger.rig.messages import LineAssembler, LineFault, Message, format_message, parse_line
from softfinger.rig.rehearsal import Rehearsal
from softfinger.rig.virtual_camera import CAMERA_AHEAD_S, ExposureFeed

_TICK_S = 0.004
_LONGEST_STEP_S = 0.02  # of the simulator's time
_MOST_WAITING_BYTES = 1_000_000  # what a host's driver would keep for a slow reader


class Simulator:
    """One loop of port, device, finger and camera exposures.

    Attributes
    ----------
    port
        Where the controller answers.
    camera
        Name of the camera that films the finger.
    """

    def __init__(self, settings: DeviceSettings, fps: float, seed: int, transcript: TextIO) -> None:
        self._scale = settings.time_scale
        self._device = Device(settings, np.random.default_rng(seed))
        self._finger = VirtualFinger(build_finger_config(), seed)
        self._rehearsal = Rehearsal()
        self._feed = ExposureFeed(fps)
        self._transcript = transcript
        self._lines = LineAssembler()
        self._waiting = bytearray()
        self._master: int | None
        self._master, self._slave = os.openpty()
        tty.setraw(self._slave)
        os.set_blocking(self._master, False)
        self.port, self.camera = os.ttyname(self._slave), self._feed.name
        self._look(0.0)  # compiles now what must not wait later
        self._began, self._now = time.monotonic(), 0.0
        self._note(0.0, "#", f"camera clock = controller clock + {CAMERA_AHEAD_S} s")

    def run(self) -> None:
        """Serve until interrupted."""
        try:
            while True:
                self._wait()
                wall = time.monotonic() - self._began
                while self._now < wall * self._scale:
                    # In short steps, so that a busy computer changes nothing of what happens
                    self._go_on(min(self._now + _LONGEST_STEP_S, wall * self._scale), wall)
                for line in self._lines.feed(self._read()):
                    self._obey(line, self._now, wall)
        finally:
            self._feed.close()
            self._unplug()

    def _go_on(self, now: float, wall: float) -> None:
        self._now = now
        for message in self._device.advance(now, wall):
            self._say(now, message)
        self._film(now)
        self._rehearse(now)

    def _wait(self) -> None:
        if self._master is None:
            time.sleep(_TICK_S)
            return
        writing = [self._master] if self._waiting else []
        select.select([self._master], writing, [], _TICK_S)
        if self._waiting:
            self._write()

    def _obey(self, line: bytes, now: float, wall: float) -> None:
        self._note(now, "<", line.decode("ascii", "replace"))
        with contextlib.suppress(LineFault):
            message = parse_line(line)
            if message.verb == "rehearse":
                self._say(now, self._rehearsal.ask(message))
                return
            if message.verb == "hello":
                self._rehearsal.end(self._device)
                self._waiting[:] = b"\n"  # the rest was meant for the recorder before
        for answer in self._device.receive(line, now, wall):
            self._say(now, answer)

    def _rehearse(self, now: float) -> None:
        begun = self._rehearsal.begin(self._device, now)
        if begun is None:
            return
        self._note(now, "#", f"rehearses {begun}")
        if begun == "unplug":
            self._unplug()
        elif begun == "camera_dies":
            self._feed.hang_up()

    def _film(self, now: float) -> None:
        for frame in self._feed.list_due_frames(now):
            if self._rehearsal.active == "camera_drops" and frame % 3:
                continue
            exposed = frame / self._feed.fps
            light = bisect.bisect(self._device.edges, exposed) % 2 == 1
            self._feed.send(frame, light, self._look(exposed))
        self._feed.flush()

    def _look(self, moment: float) -> np.ndarray:
        device = self._device
        trial = max(device.trial - 1, 0)
        return self._finger.compute_angle(trial, device.load_time, device.load_tension, moment)

    def _say(self, now: float, message: Message) -> None:
        if message.verb != "sample":
            self._note(now, ">", format_message(message).decode().rstrip())
        if len(self._waiting) < _MOST_WAITING_BYTES:
            self._waiting += self._rehearsal.spoil(message)
        self._write()

    def _write(self) -> None:
        if self._master is None:
            self._waiting.clear()
            return
        with contextlib.suppress(BlockingIOError):
            del self._waiting[: os.write(self._master, self._waiting)]

    def _read(self) -> bytes:
        if self._master is None:
            return b""
        try:
            return os.read(self._master, 65536)
        except OSError as error:
            if error.errno == errno.EAGAIN:
                return b""
            raise

    def _unplug(self) -> None:
        if self._master is not None:
            os.close(self._master)
            os.close(self._slave)
        self._master = None

    def _note(self, now: float, mark: str, text: str) -> None:
        self._transcript.write(f"{now:.6f} {mark} {text}\n")
        self._transcript.flush()


def simulate(settings: DeviceSettings, fps: float, seed: int, transcript: Path | None) -> None:
    """Run a simulated rig until interrupted.

    It prints its port and its camera.

    Parameters
    ----------
    settings
        Of the controller; its time scale accelerates finger, profile, samples and camera, but not
        the watchdog.
    fps
        The camera's frame rate [1/s], in the simulator's time.
    seed
        Of the finger's trials and the load cell's noise.
    transcript
        File that gets every line sent or received, samples left out, with the controller's time.
    """
    with (transcript or Path(os.devnull)).open("w", encoding="utf-8") as file:
        simulator = Simulator(settings, fps, seed, file)
        print(f"port {simulator.port}", f"camera {simulator.camera}", sep="\n", flush=True)
        simulator.run()
