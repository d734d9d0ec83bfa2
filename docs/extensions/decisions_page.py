"""Tables of the numbers that decide, limit work or are assumed, from their docstrings."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

from softfinger.provenance import PROJECT

ROOMS = ("mismatch", "measurement", "inference")
KINDS = ("decisions", "budget", "priors")


class Number(NamedTuple):
    """A field of a frozen class: room, kind, name, value, what it is, why, and tests."""

    room: str
    kind: str
    name: str
    value: str
    what: str
    why: str
    tests: list[str]


def list_numbers() -> Iterator[Number]:
    """Every gathered number, in the order of the files."""
    for kind in KINDS:
        for room in ROOMS:
            path = PROJECT / f"src/softfinger/{room}/{kind}.py"
            if path.exists():
                yield from read_numbers(path, room, kind)


def read_numbers(path: Path, room: str, kind: str) -> Iterator[Number]:
    """Fields of the classes of one file; what is not said is empty."""
    for owner in ast.parse(path.read_text(encoding="utf-8")).body:
        if not isinstance(owner, ast.ClassDef):
            continue
        for field, after in zip(owner.body, [*owner.body[1:], None], strict=True):
            if not isinstance(field, ast.AnnAssign) or field.value is None:
                continue
            said = ""
            if isinstance(after, ast.Expr) and isinstance(after.value, ast.Constant):
                said = " ".join(str(after.value.value).split())
            what, _, rest = said.partition("Why:")
            why, *tests = rest.split("Test:")
            names = re.findall(r"`(\w+\.py::\w+)`", " ".join(tests))
            value = ast.unparse(field.value).strip("()")
            yield Number(room, kind, field.target.id, value, what.strip(), why.strip(), names)


def describe_kind(kind: str) -> str:
    """One table of all rooms."""
    head = ["| number | value | what it is | why this value |", "| --- | --- | --- | --- |"]
    rows = [
        f"| `{n.room}.{n.name}` | `{n.value}` | {n.what} | {n.why} |"
        for n in list_numbers()
        if n.kind == kind
    ]
    return "\n".join([*head, *rows])


def describe_decisions() -> str:
    """All three tables under their headings."""
    titles = {"decisions": "Decisions", "priors": "Priors", "budget": "Budget"}
    return "\n\n".join(f"## {title}\n\n{describe_kind(kind)}" for kind, title in titles.items())
