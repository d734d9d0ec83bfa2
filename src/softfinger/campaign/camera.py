"""The camera, and the markers or dots it sees."""

from typing import Annotated, Self

from pydantic import Field, model_validator

from softfinger.campaign.section import DeclaredSection, Length

DISTORTIONS = (0, 4, 5, 8, 12, 14)
MARKER_PX = (1.0, 2000.0)

Along = Annotated[float, Field(gt=-2.0, lt=2.0)]


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

    fps: float = Field(gt=0.01, lt=1e5, description="the frames per second", examples=[30.0])
    metres_per_pixel: float | None = Field(
        default=None, gt=1e-8, lt=0.1, description="the scale of the picture", examples=[0.000235]
    )
    intrinsics: Intrinsics | None = None
    markers: dict[str, tuple[Along, ...]] = Field(
        default_factory=dict,
        description="the places of the markers on each link, in metres from its joint",
        examples=[{"base": [-0.018, -0.006], "link_1": [0.006, 0.019]}],
    )
    marker_diameter_m: Length | None = Field(
        None, description="the diameter of a marker", examples=[0.004]
    )
    marker_colour: Colour | None = Field(
        None, description="the colour of the markers; dark, light or #rrggbb", examples=["dark"]
    )
    dots: dict[Annotated[str, Field(pattern=r"^[a-z][a-z0-9]*$")], Dot] | None = Field(
        None,
        description="the dots, each by its diameter and place or colour",
        examples=[{"tip": {"diameter_px": 12.0, "at_px": [320.0, 240.0]}}],
    )

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
