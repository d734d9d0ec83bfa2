"""What ``campaign.yaml`` may say: every key, its unit and the range that is believed."""

from __future__ import annotations

import difflib
from pathlib import Path
from typing import Annotated, Any, Literal, Self

import numpy as np
from pydantic import BaseModel, ConfigDict, Field, ValidationError, model_validator
from ruamel.yaml import YAML, YAMLError
from ruamel.yaml.comments import CommentedMap
from ruamel.yaml.events import AliasEvent, CollectionEndEvent, CollectionStartEvent

from softfinger.faults import CampaignFault

FILE_NAME = "campaign.yaml"
LARGEST_FILE_BYTES = 1_000_000
DEEPEST = 20

# Bounds far outside any soft finger: what they refuse is a slip of the unit.
Length = Annotated[float, Field(gt=1e-5, lt=2.0)]
Mass = Annotated[float, Field(gt=1e-7, lt=20.0)]
Inertia = Annotated[float, Field(gt=1e-14, lt=10.0)]
Place = Annotated[float, Field(gt=-2.0, lt=2.0)]


class _Section(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True, strict=False, allow_inf_nan=False)


class Finger(_Section):
    """The finger: number of joints, and the geometry that dynamics and tracking need."""

    joints: int = Field(ge=1, le=32)
    link_length_m: tuple[Length, ...] | None = None
    link_mass_kg: tuple[Mass, ...] | None = None
    link_centre_m: tuple[Length, ...] | None = None
    link_inertia_kgm2: tuple[Inertia, ...] | None = None
    joint_length_m: Length | None = None
    wire_offset_m: Length | None = None
    bends: Literal["counter-clockwise", "clockwise"] = "counter-clockwise"

    @property
    def bends_sign(self) -> int:
        """+1 where the finger bends counter-clockwise in the picture, −1 where clockwise."""
        return 1 if self.bends == "counter-clockwise" else -1

    @model_validator(mode="after")
    def _one_value_per_joint(self) -> Self:
        for key in ("link_length_m", "link_mass_kg", "link_centre_m", "link_inertia_kgm2"):
            values = getattr(self, key)
            if values is not None and len(values) != self.joints:
                raise ValueError(
                    f"{key} has {len(values)} values, but the finger has {self.joints} joints; "
                    "give one value per link, base to tip"
                )
        return self


class Intrinsics(_Section):
    """Pinhole matrix [px] and OpenCV distortion coefficients."""

    matrix: tuple[
        tuple[float, float, float], tuple[float, float, float], tuple[float, float, float]
    ]
    distortion: tuple[float, ...] = Field(default=(), max_length=14)


class Camera(_Section):
    """The camera and the markers that it sees."""

    fps: float = Field(gt=0.01, lt=1e5)
    metres_per_pixel: float | None = Field(default=None, gt=1e-8, lt=0.1)
    intrinsics: Intrinsics | None = None
    markers: dict[str, tuple[Place, ...]]
    marker_diameter_m: Length
    marker_colour: str | None = Field(default=None, pattern=r"^(dark|light|#[0-9a-fA-F]{6})$")

    @model_validator(mode="after")
    def _one_scale(self) -> Self:
        if (self.metres_per_pixel is None) == (self.intrinsics is None):
            raise ValueError("give either metres_per_pixel or intrinsics, and not both")
        return self


class Description(_Section):
    """The whole of ``campaign.yaml``."""

    version: Literal[1]
    name: str = Field(min_length=1, max_length=200)
    source: Literal["measured", "synthetic"]
    finger: Finger
    camera: Camera | None = None
    noise_sd_rad: float | None = Field(default=None, gt=1e-7, lt=1.0)

    @model_validator(mode="after")
    def _markers_on_every_link(self) -> Self:
        if self.camera is None:
            return self
        expected = ["base", *(f"link_{i + 1}" for i in range(self.finger.joints))]
        if sorted(self.camera.markers) != sorted(expected):
            raise ValueError(
                f"camera.markers names {', '.join(sorted(self.camera.markers))}; a finger of "
                f"{self.finger.joints} joints needs exactly {', '.join(expected)}"
            )
        for link, places in self.camera.markers.items():
            if len(places) < 2 or np.any(np.diff(places) <= 0):
                raise ValueError(
                    f"camera.markers.{link} is {list(places)}; a link's direction needs at least "
                    "two markers, their places increasing towards the tip"
                )
        return self


def read_description(folder: Path) -> Description:
    """Read and validate ``campaign.yaml``.

    Raises
    ------
    CampaignFault
        The file is missing, is no YAML, or says something that is not in the format; all of its
        faults are listed, each with its line and key.
    """
    path = folder / FILE_NAME
    content = _load_yaml(path)
    try:
        return Description.model_validate(_to_plain(content))
    except ValidationError as error:
        faults = [_describe(fault, content) for fault in error.errors()]
        raise CampaignFault(str(path), faults) from None


def _load_yaml(path: Path) -> CommentedMap:
    if not path.is_file():
        raise CampaignFault(
            str(path.parent), [f"{FILE_NAME} is missing; every campaign folder has one"]
        )
    if path.stat().st_size > LARGEST_FILE_BYTES:
        raise CampaignFault(
            str(path), [f"it has {path.stat().st_size} bytes; expected less than a megabyte"]
        )
    try:
        text = path.read_text(encoding="utf-8")
        _refuse_bombs(path, text)
        content = YAML(typ="rt").load(text)
    except UnicodeDecodeError as error:
        raise CampaignFault(str(path), [f"byte {error.start} is not UTF-8 text"]) from None
    except YAMLError as error:
        raise CampaignFault(
            str(path), [f"it is not YAML: {' '.join(str(error).split())}"]
        ) from None
    if not isinstance(content, CommentedMap):
        raise CampaignFault(str(path), ["it must hold keys and values, as in 'version: 1'"])
    return content


def _refuse_bombs(path: Path, text: str) -> None:
    """Refuse aliases, which can make a small file expand without end, and deep nesting."""
    depth = 0
    for event in YAML(typ="safe").parse(text):
        if isinstance(event, AliasEvent):
            raise CampaignFault(str(path), ["it holds a YAML alias (*name); write values out"])
        depth += isinstance(event, CollectionStartEvent) - isinstance(event, CollectionEndEvent)
        if depth > DEEPEST:
            raise CampaignFault(
                str(path), [f"it nests keys or lists deeper than {DEEPEST} times; expected 4"]
            )


def _to_plain(node: Any) -> Any:  # noqa: ANN401 (a YAML tree holds anything)
    if isinstance(node, dict):
        return {str(key): _to_plain(value) for key, value in node.items()}
    if isinstance(node, list):
        return [_to_plain(value) for value in node]
    return node


def _describe(fault: Any, content: CommentedMap) -> str:  # noqa: ANN401 (pydantic's error record)
    place = tuple(fault["loc"])
    key = ".".join(str(part + 1) if isinstance(part, int) else part for part in place)
    where = f"line {_find_line(content, place)}" + (f", {key}" if key else "")
    if fault["type"] == "extra_forbidden":
        known = _known_keys(place[:-1])
        near = difflib.get_close_matches(str(place[-1]), known, n=1)
        hint = f"did you mean '{near[0]}'?" if near else f"known here: {', '.join(known)}"
        return f"{where}: unknown key '{place[-1]}'; {hint}"
    if fault["type"] == "missing":
        return f"{where}: this key is missing; see the campaign format"
    message = fault["msg"].removeprefix("Value error, ")
    message = message[0].lower() + message[1:]
    if isinstance(fault["input"], dict):
        return f"{where}: {message}"
    return f"{where}: is {fault['input']!r}; {message}; mind the unit in the key's name"


def _known_keys(place: tuple[str | int, ...]) -> list[str]:
    section: type[BaseModel] = Description
    for part in place:
        section = {"finger": Finger, "camera": Camera, "intrinsics": Intrinsics}.get(
            str(part), section
        )
    return sorted(section.model_fields)


def _find_line(content: CommentedMap, place: tuple[str | int, ...]) -> int:
    line, node = 0, content
    for part in place:
        try:
            line = node.lc.key(part)[0] if isinstance(node, CommentedMap) else node.lc.item(part)[0]
            node = node[part]
        except (KeyError, IndexError, AttributeError, TypeError):
            break
    return line + 1
