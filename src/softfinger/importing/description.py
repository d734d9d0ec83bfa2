"""What ``import.yaml`` may contain.

It states which column is what, which rows are one trial, units, clock and sign. Every key may be
left out; it is then guessed, and the guess is listed.
"""

from __future__ import annotations

import io
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, Literal

from pydantic import Field, ValidationError, field_validator, model_validator
from ruamel.yaml import YAML

from softfinger.campaign import DeclaredFinger
from softfinger.campaign.section import DeclaredSection
from softfinger.campaign.specimen import Unit, Words
from softfinger.gate import read_document, read_value
from softfinger.importing.faults import ImportFault, ImportFaults

FILE_NAME = "import.yaml"
DELIMITER_NAMES = {r"\t": "\t", "tab": "\t", "space": " "}
By = Literal["file", "folder", "sheet", "block", "column", "columns", "group", "clock", "all"]
PointsAs = Literal["markers", "bending", "direction", "displacement"]


class Tables(DeclaredSection):
    """Which files are read, and how.

    Attributes
    ----------
    files
        Patterns below the source, as ``runs/*.csv``; absent = every table.
    sheets
        Names of sheets; absent = all that are not hidden.
    headings
        Numbers of the heading rows, from 1.
    missing
        Words that are gaps.
    delimiter
        A character; ``tab`` and ``space`` are known by name.
    """

    files: tuple[str, ...] | None = None
    sheets: tuple[str, ...] | None = None
    hidden_sheets: bool = False
    delimiter: str | None = None
    decimal: Literal[".", ","] | None = None
    encoding: str | None = None
    headings: tuple[int, ...] = ()
    missing: tuple[str, ...] = ()

    @field_validator("delimiter")
    @classmethod
    def _one_character(cls, value: str | None) -> str | None:
        if value is not None and len(value) != 1 and value not in DELIMITER_NAMES:
            raise ValueError("expected one character, or tab or space")
        return value


class TrialRows(DeclaredSection):
    """Which rows are one trial.

    `column` names the column that names the trial, where there is one.

    Attributes
    ----------
    by
        ``file``, ``sheet`` or ``block`` under a heading: each is one; ``column``: its cells name
        the trial of a row; ``columns``: each column beside the clock is one; ``group``: columns of
        the same names repeat; ``clock``: it starts anew; ``folder`` or ``all``: the files of a
        folder, or all, are topics of one.
    leave_out
        Names of trials that are not imported.
    """

    by: By | None = None
    column: str | None = None
    leave_out: tuple[str, ...] = ()


class Clock(DeclaredSection):
    """The time of each row.

    It is a column with its unit, or a rate.

    `start`: times as recorded, or counted from the first row of each trial, or of each file where
    their clocks have nothing in common.
    """

    column: str | None = None
    unit: Unit | None = None
    frames_per_second: float | None = Field(default=None, gt=0.0)
    interval_s: float | None = Field(default=None, gt=0.0)
    start: Literal["as recorded", "first row", "each first row"] | None = None

    @model_validator(mode="after")
    def _one_clock(self) -> Clock:
        if self.frames_per_second and self.interval_s:
            raise ValueError("give frames_per_second or interval_s, and not both")
        return self


class Points(DeclaredSection):
    """Points whose coordinates are logged, base to tip.

    `lost`: what a point that was not found looks like; `zero` = both coordinates are 0.
    """

    names: tuple[str, ...] | None = None
    read_as: PointsAs | None = None
    lost: Literal["zero", "empty"] | None = None
    least_trust: float | None = None
    up: Literal["y", "-y"] | None = None


class MotionColumns(DeclaredSection):
    """The motion: columns of angles, or points."""

    columns: tuple[str, ...] | None = None
    points: Points | None = None
    quantity: Words | None = None
    unit: Unit | None = None
    sign: Literal[1, -1] | None = None
    start: Literal["as recorded", "first row"] | None = None


class LoadColumns(DeclaredSection):
    """The load of a trial.

    It is a column, a key stated above the table, a number, or none that is known.

    A load that is stated or a number acts from `from_s` on. `between` the rows of its column it
    is a straight line, or held until the next row.
    """

    column: str | None = None
    stated: str | None = None
    value: float | None = None
    none: bool = False
    quantity: Words | None = None
    unit: Unit | None = None
    sign: Literal[1, -1] | None = None
    from_s: float | None = None
    between: Literal["line", "held"] | None = None

    @model_validator(mode="after")
    def _one_source(self) -> LoadColumns:
        given = [self.column, self.stated, self.value, self.none or None]
        if sum(source is not None for source in given) > 1:
            raise ValueError("give one of column, stated, value and none")
        return self


class Covariate(DeclaredSection):
    """A number of each trial: stated, or a mean."""

    name: str = Field(pattern=r"^\w+$")
    stated: str | None = None
    column: str | None = None


class ImportDescription(DeclaredSection):
    """The whole of ``import.yaml``."""

    version: Literal[1] = 1
    name: str | None = Field(default=None, min_length=1, max_length=200)
    source: Literal["measured", "synthetic"] = "measured"
    tables: Tables = Tables()
    trials: TrialRows = TrialRows()
    clock: Clock = Clock()
    motion: MotionColumns = MotionColumns()
    load: LoadColumns = LoadColumns()
    covariates: tuple[Covariate, ...] | None = None
    finger: DeclaredFinger | None = None


def read_import_description(path: Path | None, settings: Sequence[str] = ()) -> ImportDescription:
    """Read an import description.

    Single keys are put over it.

    Parameters
    ----------
    path
        The file; None = nothing is declared.
    settings
        Such as ``clock.unit=ms``; a value is YAML.

    Raises
    ------
    ImportFault, ImportFaults
        The file is missing or no YAML; keys that are unknown or out of range, all listed.
    """
    content: dict[str, Any] = {}
    if path is not None:
        if not path.is_file():
            raise ImportFault(
                f"{path}: the file does not exist; run with --dry-run to have one written"
            )
        content = dict(read_document(path).content)
    for setting in settings:
        key, equals, value = setting.partition("=")
        if not equals:
            raise ImportFault(f"--set {setting}: expected key=value, as in clock.unit=ms")
        _put(content, key.strip().split("."), read_value(value, f"--set {setting}"))
    try:
        return ImportDescription.model_validate(content)
    except ValidationError as error:
        faults = [_describe(fault) for fault in error.errors()]
        raise ImportFaults(str(path or "--set"), faults) from None


def _put(content: dict[str, Any], keys: Sequence[str], value: object) -> None:
    for key in keys[:-1]:
        inner = content.get(key)
        content[key] = inner if isinstance(inner, dict) else {}
        content = content[key]
    content[keys[-1]] = value


def _describe(fault: Mapping[str, Any]) -> str:
    key = ".".join(str(part) for part in fault["loc"])
    if fault["type"] == "extra_forbidden":
        return f"{key}: this key is unknown; see the documentation of import.yaml"
    message = fault["msg"].removeprefix("Value error, ")
    return f"{key}: is {fault['input']!r}; {message[:1].lower()}{message[1:]}"


def format_description(description: ImportDescription, guessed: Sequence[str] = ()) -> str:
    """Write a description as YAML, guesses as comments."""
    content = description.model_dump(mode="json", exclude_none=True, exclude_defaults=False)
    stream = io.StringIO()
    writer = YAML()
    writer.width = 100
    writer.dump(_drop_empty(content), stream)
    lines = [f"#   {line}" for line in guessed]
    head = ["# How the recordings were read; change what is wrong and import again with --spec."]
    head += ["# Guessed:", *lines] if lines else []
    return "\n".join(head) + "\n" + stream.getvalue()


def _drop_empty(node: Any) -> Any:  # noqa: ANN401
    if not isinstance(node, dict):
        return node
    kept = {key: _drop_empty(value) for key, value in node.items()}
    return {k: v for k, v in kept.items() if v not in ({}, [], False, None)}
