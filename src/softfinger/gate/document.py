"""Others' YAML: plain values, lines, limits."""

import math
import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from ruamel.yaml import YAML, YAMLError
from ruamel.yaml.events import (
    AliasEvent,
    DocumentStartEvent,
    Event,
    MappingEndEvent,
    MappingStartEvent,
    NodeEvent,
    ScalarEvent,
    SequenceEndEvent,
    SequenceStartEvent,
)

from softfinger.faults import Fault, show
from softfinger.gate.files import read_text

LARGEST_BYTES = 250_000
MOST_VALUES = 20_000
DEEPEST = 20
LONGEST_TEXT = 2_000
LONGEST_NUMBER = 40
LARGEST_WHOLE = 2**53  # whole numbers beyond are no numbers of JSON

# Plain scalars of YAML 1.2's core schema.
NULL = re.compile(r"~|null|Null|NULL|")
TRUE, FALSE = re.compile(r"true|True|TRUE"), re.compile(r"false|False|FALSE")
WHOLE = re.compile(r"[-+]?[0-9]+")
REAL = re.compile(r"[-+]?(\.[0-9]+|[0-9]+(\.[0-9]*)?)([eE][-+]?[0-9]+)?")
NOT_FINITE = re.compile(r"[-+]?\.(inf|Inf|INF)|\.(nan|NaN|NAN)")

Place = tuple[str | int, ...]


@dataclass(frozen=True)
class Document:
    """Keys and values of a file, with their lines."""

    content: Mapping[str, Any]
    lines: Mapping[Place, int] = field(default_factory=dict)

    def find_line(self, place: Place) -> int:
        """Line of a value or of its nearest parent."""
        while place and place not in self.lines:
            place = place[:-1]
        return self.lines.get(place, 1)


def read_document(path: Path) -> Document:
    """Read a YAML document of plain values.

    They are keys, text, numbers, true, false, null and lists.

    What a small file can make slow, large or strange is no part of it: aliases, tags, directives,
    keys that are no text, a second document, dates (which remain text).

    Raises
    ------
    Fault
        It cannot be read, is no such document or exceeds a limit; the message names the line.
    """
    content, lines = _parse(read_text(path, LARGEST_BYTES), str(path))
    if not isinstance(content, dict):
        raise Fault(f"{path}: expected keys and values, as in 'version: 1'")
    return Document(content, lines)


def read_value(text: str, place: str) -> Any:  # noqa: ANN401 (a YAML tree contains anything)
    """Read one plain value of YAML, under the same rules.

    Parameters
    ----------
    place
        Where the text is from, as a fault shall name it.

    Raises
    ------
    Fault
        As :func:`read_document`.
    """
    return _parse(text, place)[0]


def _parse(text: str, place: str) -> tuple[Any, dict[Place, int]]:
    try:
        reader = _EventReader(YAML(typ="safe", pure=True).parse(text))
        return reader.read_document(), reader.lines
    except _Refusal as refusal:
        raise Fault(f"{place}, line {refusal.line}: {refusal}") from None
    except YAMLError as error:
        reason = " ".join(str(error).split())[:300]
        raise Fault(f"{place}: it is not YAML: {reason}") from None
    except (ValueError, AssertionError, LookupError, TypeError, AttributeError):
        # The parser's own slips, on escapes and directives that are out of range.
        raise Fault(f"{place}: it is not YAML: an escape or a directive in it is wrong") from None


class _Refusal(Exception):
    def __init__(self, event: Event, said: str) -> None:
        super().__init__(said)
        self.line = event.start_mark.line + 1


class _EventReader:
    """Builds plain values from the events of a parser."""

    def __init__(self, events: Iterator[Event]) -> None:
        self.events = events
        self.lines: dict[Place, int] = {}
        self.count = 0

    def read_document(self) -> Any:  # noqa: ANN401 (a YAML tree contains anything)
        content, documents = None, 0
        for event in self.events:
            if isinstance(event, DocumentStartEvent):
                documents += 1
                if documents > 1:
                    raise _Refusal(event, "a second document begins; expected one")
                if event.tags:
                    raise _Refusal(event, "it begins with a directive; remove the line with %")
            elif isinstance(event, NodeEvent):
                content = self._read_value(event, ())
        return content

    def _read_value(self, event: Event, place: Place) -> Any:  # noqa: ANN401
        self.count += 1
        self._refuse(event, len(place))
        self.lines.setdefault(place, event.start_mark.line + 1)
        if isinstance(event, ScalarEvent):
            return _interpret(event)
        if isinstance(event, SequenceStartEvent):
            return self._read_list(place)
        return self._read_keys(place)

    def _refuse(self, event: Event, depth: int) -> None:
        if isinstance(event, AliasEvent):
            raise _Refusal(event, "it contains a YAML alias (*name); write the values out")
        if self.count > MOST_VALUES:
            raise _Refusal(event, f"it has more than {MOST_VALUES} values")
        if depth > DEEPEST:
            raise _Refusal(event, f"it nests keys or lists deeper than {DEEPEST} times; expected 4")
        if event.tag is not None:
            raise _Refusal(
                event, f"it contains the YAML tag {show(str(event.tag))}; write plain values"
            )

    def _read_list(self, place: Place) -> list:
        values: list = []
        for event in self.events:
            if isinstance(event, SequenceEndEvent):
                break
            values.append(self._read_value(event, (*place, len(values))))
        return values

    def _read_keys(self, place: Place) -> dict:
        values: dict = {}
        for event in self.events:
            if isinstance(event, MappingEndEvent):
                break
            if isinstance(event, MappingStartEvent | SequenceStartEvent):
                raise _Refusal(event, "a key is a list or has keys itself; expected a word")
            self._refuse(event, len(place))
            key = _read_text(event)
            if key in values:
                raise _Refusal(event, f"the key {show(key)} appears twice")
            self.lines[(*place, key)] = event.start_mark.line + 1
            values[key] = self._read_value(next(self.events), (*place, key))
        return values


def _read_text(event: ScalarEvent) -> str:
    text = event.value
    if len(text) > LONGEST_TEXT:
        raise _Refusal(event, f"a text has {len(text)} characters; expected at most {LONGEST_TEXT}")
    if not text.replace("\n", "").replace("\t", "").isprintable():
        raise _Refusal(event, f"{show(text)} contains a character that cannot be printed")
    return text


def _interpret(event: ScalarEvent) -> bool | int | float | str | None:
    text = _read_text(event)
    if not event.implicit[0]:
        return text
    if NULL.fullmatch(text):
        return None
    if TRUE.fullmatch(text) or FALSE.fullmatch(text):
        return text.lower() == "true"
    if not REAL.fullmatch(text) and not NOT_FINITE.fullmatch(text):
        return text
    number = math.nan if NOT_FINITE.fullmatch(text) else float(text)
    if len(text) > LONGEST_NUMBER or not math.isfinite(number):
        raise _Refusal(event, f"the number is {show(text)}; expected a finite one")
    if not WHOLE.fullmatch(text):
        return number
    if abs(number) >= LARGEST_WHOLE:
        raise _Refusal(event, f"the number is {show(text)}; expected at most {LARGEST_WHOLE:g}")
    return int(text)
