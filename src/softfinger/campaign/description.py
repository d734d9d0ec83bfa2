"""Keys, units and believed ranges of ``campaign.yaml``."""

import difflib
from collections.abc import Iterator
from pathlib import Path
from typing import Annotated, Any, Literal, Self

import numpy as np
from pydantic import BaseModel, Field, ValidationError, model_validator

from softfinger.campaign.camera import Camera, Dot, Intrinsics
from softfinger.campaign.section import DeclaredSection, Length
from softfinger.campaign.specimen import Motion, Quantity, Specimen
from softfinger.faults import CampaignFault, Fault, show
from softfinger.gate import Document, read_document

FILE_NAME = "campaign.yaml"

Mass = Annotated[float, Field(gt=1e-7, lt=20.0)]
Inertia = Annotated[float, Field(gt=1e-14, lt=10.0)]
Place = tuple[str | int, ...]


class DeclaredFinger(DeclaredSection):
    """The finger: joints and, for dynamics, geometry."""

    joints: int = Field(ge=1, le=32, description="the number of joints, base to tip", examples=[3])
    link_length_m: tuple[Length, ...] | None = Field(
        None, description="the length of each link, base to tip", examples=[[0.025, 0.025, 0.025]]
    )
    link_mass_kg: tuple[Mass, ...] | None = Field(
        None, description="the mass of each link", examples=[[0.005, 0.005, 0.005]]
    )
    link_centre_m: tuple[Length, ...] | None = Field(
        None,
        description=(
            "the distance from each link's joint to its centre of mass; default: the middle"
        ),
        examples=[[0.0125, 0.0125, 0.0125]],
    )
    link_inertia_kgm2: tuple[Inertia, ...] | None = Field(
        None,
        description="the inertia of each link about its centre of mass; default: that of a rod",
        examples=[[2.6e-7, 2.6e-7, 2.6e-7]],
    )
    joint_length_m: Length | None = Field(
        None, description="the length of the soft part of a joint", examples=[0.008]
    )
    wire_offset_m: Length | None = Field(
        None, description="the distance from the joint's middle line to the wire", examples=[0.005]
    )
    bends: Literal["counter-clockwise", "clockwise"] = Field(
        "counter-clockwise",
        description=(
            "the direction of bending under a pull, in the picture; clockwise or counter-clockwise"
        ),
        examples=["counter-clockwise"],
    )

    @property
    def bends_sign(self) -> int:
        """+1 for counter-clockwise bending in the picture, −1 otherwise."""
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


class Description(DeclaredSection):
    """The whole of ``campaign.yaml``."""

    version: Literal[1] = Field(description="the version of this format", examples=[1])
    name: str = Field(
        min_length=1,
        max_length=200,
        description="what was recorded, in a few words",
        examples=["index finger, first pulls"],
    )
    source: Literal["measured", "synthetic"] = Field(
        description="measured, or synthetic for a simulation"
    )
    finger: DeclaredFinger | None = None
    specimen: Specimen | None = None
    camera: Camera | None = None
    noise_sd_rad: float | None = Field(
        default=None,
        gt=1e-7,
        lt=1.0,
        description="the sd of the angles' noise; estimated where it is not given",
        examples=[0.003],
    )

    @model_validator(mode="after")
    def _finger_or_specimen(self) -> Self:
        if (self.finger is None) == (self.specimen is None):
            raise ValueError("give either finger or specimen, and not both")
        if self.specimen is not None and self.noise_sd_rad is not None:
            raise ValueError(
                "noise_sd_rad belongs to a finger; give specimen.motion.noise_sd, in the unit of "
                "the motion"
            )
        if self.camera is not None and (self.specimen is None) == bool(self.camera.dots):
            raise ValueError("camera.dots belong to a specimen, camera.markers to a finger's links")
        return self

    @model_validator(mode="after")
    def _markers_on_every_link(self) -> Self:
        if self.camera is None or self.finger is None:
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


SECTIONS: dict[str, type[BaseModel]] = {
    "finger": DeclaredFinger,
    "specimen": Specimen,
    "motion": Motion,
    "load": Quantity,
    "camera": Camera,
    "dots": Dot,
    "intrinsics": Intrinsics,
}


def read_description(folder: Path) -> Description:
    """Read and validate ``campaign.yaml``.

    Raises
    ------
    CampaignFault
        The file is missing, is no YAML, or contains something that is not in the format; all of its
        faults are listed, each with its line and key.
    """
    path = folder / FILE_NAME
    try:
        document = read_document(path)
    except Fault as fault:
        raise CampaignFault(str(folder), [str(fault).removeprefix(f"{folder}/")]) from None
    empty = list(_find_empty(document.content))
    faults = [f"{_locate(place, document)}: {describe_empty(place)}" for place in empty]
    try:
        description = Description.model_validate(document.content)
    except ValidationError as error:
        # what concerns an empty key, or keys together of which one is empty, is no fault of its own
        faults += [
            _describe(fault, document)
            for fault in error.errors()
            if not any(place[: len(fault["loc"])] == fault["loc"] for place in empty)
        ]
    if faults:
        raise CampaignFault(str(path), faults)
    return description


def _find_empty(content: Any, place: Place = ()) -> Iterator[Place]:  # noqa: ANN401 (YAML)
    """Places of keys that have no value."""
    if isinstance(content, dict):
        for key, value in content.items():
            yield from _find_empty(value, (*place, key))
    elif content is None:
        yield place


def _locate(place: Place, document: Document) -> str:
    key = ".".join(str(part + 1) if isinstance(part, int) else part for part in place)
    return f"line {document.find_line(place)}" + (f", {key}" if key else "")


def _describe(fault: Any, document: Document) -> str:  # noqa: ANN401 (pydantic's error record)
    place = tuple(fault["loc"])
    where = _locate(place, document)
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
    found = show(repr(fault["input"]))[1:-1]
    said = f"{where}: is {found}; {message}"
    of_numbers = fault["type"].startswith(("greater", "less", "float", "int", "finite"))
    return f"{said}; check the unit in the key's name" if of_numbers else said


def _known_keys(place: Place) -> list[str]:
    return sorted(_find_section(place).model_fields)


def describe_empty(place: Place) -> str:
    """Sentence on how to fill an empty key.

    >>> describe_empty(("finger", "joints"))
    'is still empty; fill in the number of joints, base to tip, as in 3'
    """
    field = _find_section(place[:-1]).model_fields.get(str(place[-1]))
    if field is None or field.description is None:
        return "is still empty; fill it in, or remove the line"
    example = f", as in {field.examples[0]!r}" if field.examples else ""
    return f"is still empty; fill in {field.description}{example}"


def _find_section(place: Place) -> type[BaseModel]:
    section: type[BaseModel] = Description
    for part in place:
        section = SECTIONS.get(str(part), section)
    return section
