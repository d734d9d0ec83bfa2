"""Keys, units and believed ranges of ``campaign.yaml``."""

import difflib
from pathlib import Path
from typing import Annotated, Any, Literal, Self

import numpy as np
from pydantic import BaseModel, Field, ValidationError, model_validator

from softfinger.campaign.section import DeclaredSection
from softfinger.campaign.specimen import Motion, Quantity, Specimen
from softfinger.faults import CampaignFault, Fault, show
from softfinger.gate import Document, read_document

FILE_NAME = "campaign.yaml"
DISTORTIONS = (0, 4, 5, 8, 12, 14)
MARKER_PX = (1.0, 2000.0)

# Bounds far outside any soft finger: what they refuse is a slip of the unit.
Length = Annotated[float, Field(gt=1e-5, lt=2.0)]
Mass = Annotated[float, Field(gt=1e-7, lt=20.0)]
Inertia = Annotated[float, Field(gt=1e-14, lt=10.0)]
Place = Annotated[float, Field(gt=-2.0, lt=2.0)]


class DeclaredFinger(DeclaredSection):
    """The finger: joints and, for dynamics, geometry."""

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


class Intrinsics(DeclaredSection):
    """Pinhole matrix [px] and OpenCV distortion coefficients."""

    matrix: tuple[
        tuple[float, float, float], tuple[float, float, float], tuple[float, float, float]
    ]
    distortion: tuple[float, ...] = Field(default=(), max_length=14)

    @model_validator(mode="after")
    def _pinhole(self) -> Self:
        focal = (self.matrix[0][0], self.matrix[1][1])
        below = (self.matrix[1][0], self.matrix[2][0], self.matrix[2][1], self.matrix[2][2] - 1.0)
        if min(focal) < 1.0 or any(below):
            raise ValueError(
                "matrix must be [[fx, s, cx], [0, fy, cy], [0, 0, 1]] with focal lengths fx and fy "
                "of at least 1 px"
            )
        if len(self.distortion) not in DISTORTIONS:
            raise ValueError(
                f"distortion has {len(self.distortion)} coefficients; OpenCV knows "
                f"{', '.join(map(str, DISTORTIONS))}"
            )
        return self


Colour = Annotated[str, Field(pattern=r"^(dark|light|#[0-9a-fA-F]{6})$")]
HexColour = Annotated[str, Field(pattern=r"^#[0-9a-fA-F]{6}$")]


class Dot(DeclaredSection):
    """A dot, found by place or own colour."""

    diameter_px: float = Field(gt=1.0, lt=1e4)
    at_px: tuple[float, float] | None = None
    colour: HexColour | None = None

    @model_validator(mode="after")
    def _one_way_to_know_it(self) -> Self:
        if (self.at_px is None) == (self.colour is None):
            raise ValueError("give either at_px or colour (#rrggbb), and not both")
        return self


class Camera(DeclaredSection):
    """The camera, and the markers or dots it sees."""

    fps: float = Field(gt=0.01, lt=1e5)
    metres_per_pixel: float | None = Field(default=None, gt=1e-8, lt=0.1)
    intrinsics: Intrinsics | None = None
    markers: dict[str, tuple[Place, ...]] = Field(default_factory=dict)
    marker_diameter_m: Length | None = None
    marker_colour: Colour | None = None
    dots: dict[Annotated[str, Field(pattern=r"^[a-z][a-z0-9]*$")], Dot] | None = None

    @model_validator(mode="after")
    def _markers_or_dots(self) -> Self:
        if bool(self.markers) == bool(self.dots):
            raise ValueError("give either markers (on links) or dots, and not both")
        if self.markers and self.marker_diameter_m is None:
            raise ValueError("marker_diameter_m is missing; markers need it")
        if self.dots and len({dot.at_px is None for dot in self.dots.values()}) > 1:
            raise ValueError("give at_px of every dot, or the colour of every dot")
        return self

    @model_validator(mode="after")
    def _one_scale(self) -> Self:
        if self.dots:
            return self
        if (self.metres_per_pixel is None) == (self.intrinsics is None):
            raise ValueError("give either metres_per_pixel or intrinsics, and not both")
        if self.metres_per_pixel is not None and self.marker_diameter_m is not None:
            size = self.marker_diameter_m / self.metres_per_pixel
            if not MARKER_PX[0] <= size <= MARKER_PX[1]:
                raise ValueError(
                    f"a marker of {self.marker_diameter_m:g} m at {self.metres_per_pixel:g} m per "
                    f"pixel would have {size:.3g} px; expected {MARKER_PX[0]:g} to "
                    f"{MARKER_PX[1]:g} px"
                )
        return self


class Description(DeclaredSection):
    """The whole of ``campaign.yaml``."""

    version: Literal[1]
    name: str = Field(min_length=1, max_length=200)
    source: Literal["measured", "synthetic"]
    finger: DeclaredFinger | None = None
    specimen: Specimen | None = None
    camera: Camera | None = None
    noise_sd_rad: float | None = Field(default=None, gt=1e-7, lt=1.0)

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
    try:
        return Description.model_validate(document.content)
    except ValidationError as error:
        faults = [_describe(fault, document) for fault in error.errors()]
        raise CampaignFault(str(path), faults) from None


def _describe(fault: Any, document: Document) -> str:  # noqa: ANN401 (pydantic's error record)
    place = tuple(fault["loc"])
    key = ".".join(str(part + 1) if isinstance(part, int) else part for part in place)
    where = f"line {document.find_line(place)}" + (f", {key}" if key else "")
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
    return f"{where}: is {found}; {message}; mind the unit in the key's name"


def _known_keys(place: tuple[str | int, ...]) -> list[str]:
    section: type[BaseModel] = Description
    for part in place:
        section = SECTIONS.get(str(part), section)
    return sorted(section.model_fields)
