r"""Lines between recorder and controller: text, numbered, checksummed.

A line is ``BODY*CCCC\n``: BODY is ``NUMBER VERB key=value key=value …`` in printable ASCII, CCCC
the CRC-16/CCITT-FALSE of BODY (polynomial 0x1021, initial value 0xFFFF) in four hexadecimal
digits. A request carries a number from 1; its answer carries the same one and the verb ``ok`` or
``error``. What the controller sends unasked (``sample``, ``event``) carries 0. The verbs are in
docs/rig/protocol.md.
"""

import binascii
from collections.abc import Mapping
from dataclasses import dataclass, field

from softfinger.faults import Fault

VERSION = 1
LONGEST_LINE = 200
_SHOWN = 60


class LineFault(Fault):
    """A line that cannot be trusted."""


@dataclass(frozen=True)
class Message:
    """One line's content; values are text."""

    number: int
    verb: str
    fields: Mapping[str, str] = field(default_factory=dict)

    def get_integer(self, key: str) -> int:
        """Integer field; its unit is the key's suffix.

        Raises
        ------
        LineFault
            The field is missing or no integer.
        """
        try:
            return int(self.fields[key])
        except (KeyError, ValueError):
            said = self.fields.get(key, "missing")
            raise LineFault(f"'{self.verb}': {key} is {said}; expected an integer") from None


def compute_checksum(body: bytes) -> int:
    """Compute the CRC-16/CCITT-FALSE of a line's body.

    The catalogue of Williams ("A painless guide to CRC error detection algorithms", 1993) gives
    0x29B1 for its check string:

    >>> hex(compute_checksum(b"123456789"))
    '0x29b1'
    """
    return binascii.crc_hqx(body, 0xFFFF)


def format_message(message: Message) -> bytes:
    r"""Write a message as a line.

    >>> format_message(Message(7, "stream", {"rate_hz": "100"}))
    b'7 stream rate_hz=100*824C\n'
    """
    words = [str(message.number), message.verb]
    words += [f"{key}={value}" for key, value in message.fields.items()]
    body = " ".join(words).encode("ascii")
    return b"%b*%04X\n" % (body, compute_checksum(body))


def parse_line(line: bytes) -> Message:
    """Read a line, without its line end.

    Raises
    ------
    LineFault
        No checksum or a wrong one, or a body that is not ``NUMBER VERB key=value …``.
    """
    shown = repr(line[:_SHOWN].decode("ascii", "replace"))
    body, star, checksum = line.rpartition(b"*")
    if not star:
        raise LineFault(f"the line {shown} has no checksum; is it cut off, or garbage?")
    expected = b"%04X" % compute_checksum(body)
    if checksum != expected:
        said = checksum[:8].decode("ascii", "replace")
        raise LineFault(
            f"the line {shown} has the checksum {said!r}; its text gives {expected.decode()}"
        )
    try:
        number, verb, *pairs = body.decode("ascii").split(" ")
        fields = dict(pair.split("=", 1) for pair in pairs)
        return Message(int(number), verb, fields)
    except ValueError:
        raise LineFault(f"the line {shown} is not 'NUMBER VERB key=value …'") from None


class LineAssembler:
    """Cuts any pieces of bytes into lines."""

    def __init__(self) -> None:
        self._begun = b""

    def feed(self, received: bytes) -> list[bytes]:
        r"""Add bytes; return the lines that they complete.

        Empty lines are left out.

        A line that grows beyond LONGEST_LINE is handed out as it is: it has no right checksum.

        >>> assembler = LineAssembler()
        >>> assembler.feed(b"1 he"), assembler.feed(b"llo\r\n\n2 a")
        ([], [b'1 hello'])
        """
        *complete, self._begun = (self._begun + received).split(b"\n")
        if len(self._begun) > LONGEST_LINE:
            complete.append(self._begun)
            self._begun = b""
        return [line.rstrip(b"\r") for line in complete if line.strip()]
