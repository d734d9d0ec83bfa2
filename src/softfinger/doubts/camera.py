"""The camera's scale against the finger's size."""

from collections.abc import Iterator, Sequence

import numpy as np

from softfinger.doubts.dimension import doubt_range
from softfinger.doubts.doubt import Doubt

LINK_PX = (15.0, 5000.0)
MARKER_PX = (2.5, 500.0)
FRAMES_PER_S = (1.0, 5000.0)


def doubt_camera(
    fps: float,
    metres_per_pixel: float | None,
    marker_diameter_m: float,
    link_length_m: Sequence[float] | None,
) -> Iterator[Doubt]:
    """Doubt the declared camera and its markers."""
    yield from doubt_range(
        "camera.fps", fps, FRAMES_PER_S, "1/s", "a frame interval in place of a rate"
    )
    if link_length_m is None:
        return
    link = float(np.median(link_length_m))
    yield from doubt_range(
        "a marker's diameter over a link's length",
        marker_diameter_m / link,
        (0.005, 1.0),
        "",
        "the unit of marker_diameter_m",
    )
    if metres_per_pixel is not None:
        cause = "the unit of metres_per_pixel, or pixels per metre"
        yield from doubt_range("a link's length", link / metres_per_pixel, LINK_PX, "px", cause)
        size = marker_diameter_m / metres_per_pixel
        yield from doubt_range("a marker's diameter", size, MARKER_PX, "px", cause)
