"""Faults that the simulator rehearses on request.

Nobody then meets them first on a real finger.

``rehearse fault=NAME after_ms=N`` lets NAME happen N ms of controller time after the next start; no
other controller knows this verb. A lasting fault ends with the next ``hello``.
"""

from typing import Literal, get_args

from softfinger.rig.device import Device
from softfinger.rig.messages import Message, format_message

FaultName = Literal[
    "garbage",  # bytes that are no text
    "partial_line",  # a line that loses its second half and its end
    "wrong_checksum",
    "wrong_version",  # the next hello is answered by another version of the protocol
    "stall",  # no samples any more, though requests are answered
    "unplug",  # the cable is pulled; the controller goes on
    "overshoot",  # something pulls beyond the limit
    "ignored_overshoot",  # the same, and the firmware lets it happen
    "camera_drops",  # two frames of three are lost
    "camera_dies",
]
NAMES: tuple[FaultName, ...] = get_args(FaultName)
_DISTURBANCE_N = 100.0


class Rehearsal:
    """What is asked for, and what goes on now.

    Attributes
    ----------
    active
        The fault that has begun and not ended.
    """

    def __init__(self) -> None:
        self.active: str | None = None
        self._pending: tuple[str, float] | None = None

    def ask(self, message: Message) -> Message:
        """Take note of a ``rehearse`` request; return its answer."""
        name = message.fields.get("fault", "")
        if name not in NAMES:
            return Message(message.number, "error", {"why": "unknown_fault"})
        self._pending = (name, message.get_integer("after_ms") / 1e3)
        return Message(message.number, "ok")

    def begin(self, device: Device, now: float) -> str | None:
        """Begin the pending fault when due; its name then."""
        if self._pending is None or device.state != "running":
            return None
        name, after = self._pending
        if now < device.load_time[0] + after:
            return None
        self._pending, self.active = None, name
        if name in ("overshoot", "ignored_overshoot"):
            device.disturbance_n = _DISTURBANCE_N
            device.ignores_limit = name == "ignored_overshoot"
        return name

    def end(self, device: Device) -> None:
        """End a lasting fault: a new recorder greets."""
        self.active = None
        device.ignores_limit = False

    def spoil(self, message: Message) -> bytes:
        """Message as it leaves a faulty cable."""
        line = format_message(message)
        if message.verb == "ok" and "version" in message.fields and self._take("wrong_version"):
            fields = {**message.fields, "version": "999"}
            return format_message(Message(message.number, "ok", fields))
        if message.verb != "sample":
            return line
        if self.active == "stall":
            return b""
        if self._take("garbage"):
            return b"\xfe\x00\x9c\xff~#\n" + line
        if self._take("partial_line"):
            return line[: len(line) // 2]
        if self._take("wrong_checksum"):
            return line.replace(b"n=", b"n=9", 1)
        return line

    def _take(self, name: FaultName) -> bool:
        if self._pending is not None and self._pending[0] == name == "wrong_version":
            self._pending = None
            return True
        if self.active == name:
            self.active = None
            return True
        return False
