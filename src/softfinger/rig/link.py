"""The recorder's end of the serial line."""

import time
from collections import deque
from typing import Self

import serial
from serial.tools import list_ports

from softfinger.faults import Fault
from softfinger.rig.messages import LineAssembler, LineFault, Message, format_message, parse_line

BAUD_RATE = 115200  # ignored by USB controllers
_POLL_S = 0.002


class Silence(Fault):
    """A request that was not answered in time."""


class SerialLink:
    """A serial port to a controller with the protocol.

    It closes at the end of its context.

    Lines that cannot be read are skipped until `trust` (a controller that boots sends all sorts of
    things) and after `distrust`; in between the first one ends the session.
    """

    def __init__(self, port: str) -> None:
        self.port = port
        self._trusted = False
        self.skipped: LineFault | None = None
        self._lines = LineAssembler()
        self._answers: dict[int, Message] = {}
        self._unasked: deque[Message] = deque()
        self._number = 0
        self._serial = _open_port(port)

    def __enter__(self) -> Self:
        """Nothing to do: the port is open."""
        return self

    def __exit__(self, *_: object) -> None:
        """Close the port."""
        self._serial.close()

    def request(self, verb: str, timeout: float, **fields: object) -> Message:
        """Send a request and wait for its answer.

        Parameters
        ----------
        verb, fields
            As in docs/rig/protocol.md.
        timeout
            [s]

        Raises
        ------
        Silence
            No answer in time.
        Fault
            A refusal, a line that cannot be read, or the port is gone.
        """
        number = self._send(verb, **fields)
        deadline = time.monotonic() + timeout
        while number not in self._answers:
            late = time.monotonic() > deadline
            self._receive()  # once more when late: a busy computer is not a silent controller
            if late and number not in self._answers:
                raise Silence(
                    f"port {self.port}: the controller did not answer '{verb}' within {timeout:g} s"
                )
        answer = self._answers.pop(number)
        if answer.verb != "ok":
            said = ", ".join(f"{key} {value}" for key, value in answer.fields.items())
            raise Fault(f"port {self.port}: the controller refused '{verb}': {said}")
        return answer

    def poll(self) -> list[Message]:
        """What the controller has sent unasked since last time."""
        self._receive()
        said = list(self._unasked)
        self._unasked.clear()
        return said

    def trust(self) -> None:
        """Drop old lines; take every new one seriously."""
        self._trusted = True
        self._unasked.clear()

    def distrust(self) -> None:
        """Skip lines that cannot be read."""
        self._trusted = False

    def discard(self) -> None:
        """Forget everything received so far."""
        self._serial.reset_input_buffer()
        self._lines = LineAssembler()
        self._answers.clear()
        self._unasked.clear()

    def _send(self, verb: str, **fields: object) -> int:
        self._number += 1
        texts = {key: str(value) for key, value in fields.items()}
        try:
            self._serial.write(format_message(Message(self._number, verb, texts)))
        except (serial.SerialException, OSError) as error:
            raise self._describe_loss(error) from None
        return self._number

    def _receive(self) -> None:
        try:
            received = self._serial.read(max(1, self._serial.in_waiting))
        except (serial.SerialException, OSError) as error:
            raise self._describe_loss(error) from None
        for line in self._lines.feed(received):
            try:
                message = parse_line(line)
            except LineFault as fault:
                self.skipped = fault
                if self._trusted:
                    raise Fault(
                        f"port {self.port}: {fault}; check the cable, its length and the motor's "
                        "interference"
                    ) from None
                continue
            if message.number:
                self._answers[message.number] = message
            else:
                self._unasked.append(message)

    def _describe_loss(self, error: Exception) -> Fault:
        return Fault(
            f"port {self.port} is gone ({error}); plug the cable in again and check that the "
            "controller has power"
        )


def _open_port(port: str) -> serial.SerialBase:
    try:
        return serial.serial_for_url(
            port, BAUD_RATE, timeout=_POLL_S, write_timeout=1.0, exclusive=True
        )
    except (serial.SerialException, OSError, ValueError) as error:
        said = str(error)
    if "lock" in said:
        reason = "is busy: another program uses it; end that program"
    elif "Permission" in said:
        reason = "may not be opened by this user; join the group that owns it (often 'dialout')"
    else:
        found = ", ".join(sorted(info.device for info in list_ports.comports())) or "none"
        reason = f"cannot be opened ({said}); serial ports found here: {found}"
    raise Fault(f"port {port} {reason}")
