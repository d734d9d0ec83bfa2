"""Free dots: followed by place, found by colour."""

from collections.abc import Iterator, Mapping
from typing import NamedTuple

import numpy as np
import xarray as xr

from softfinger.campaign import Campaign
from softfinger.campaign.camera import Dot
from softfinger.campaign.units import find_factor
from softfinger.faults import Fault
from softfinger.tracking.angles import unwrap_array
from softfinger.tracking.body import Body
from softfinger.tracking.disc import PARAMETERS, RADIUS
from softfinger.tracking.fit import FIT_QUALITY
from softfinger.tracking.start import measure_discs, start_at_points
from softfinger.tracking.tracker import Tracker
from softfinger.tracking.video import Frame


class ColourFinder(NamedTuple):
    """Dots by colour; a `Tracker` by interface."""

    dots: Mapping[str, Dot]
    known: np.ndarray
    body: Body

    def follow(self, picture: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Find every dot in a picture.

        Returns
        -------
        fitted (marker, 8), quality (marker, 5)
            NaN where no disc of the dot's colour is seen, or several are.
        """
        fitted = np.full((len(self.dots), len(PARAMETERS)), np.nan)
        quality = np.full((len(self.dots), len(FIT_QUALITY)), np.nan)
        for k, dot in enumerate(self.dots.values()):
            found, measured = measure_discs(picture, 0.5 * dot.diameter_px, dot.colour)
            if len(found) == 1:
                fitted[k], quality[k] = found[0], measured[0]
                self.known[k] = found[0]
        return fitted, quality


def start_dots(
    frames: Iterator[Frame], dots: Mapping[str, Dot]
) -> tuple[list[float], Frame, Tracker | ColourFinder]:
    """Begin with the first picture.

    Returns
    -------
    times of the frames before it (none), the frame itself, who follows the dots from there
    """
    first = next(frames)
    radius = np.array([0.5 * dot.diameter_px for dot in dots.values()])
    if all(dot.at_px is not None for dot in dots.values()):
        places = np.array([dot.at_px for dot in dots.values()], float)
        return [], first, start_at_points(first.picture, places, radius)
    known = np.zeros((len(dots), len(PARAMETERS)))
    known[:, RADIUS] = radius
    body = Body.measure([[k] for k in range(len(dots))], known[:, :2])
    return [], first, ColourFinder(dots, known, body)


def measure_motion(markers: xr.Dataset, campaign: Campaign) -> xr.Dataset:
    """Motion of a filmed specimen's two-dot line.

    The line goes from the first dot to the second.

    Its unit decides: an angle is the line's direction, counter-clockwise as seen; a length (by
    ``metres_per_pixel``) or ``pixel`` is the distance of the two dots.

    Parameters
    ----------
    markers : Dataset
        ``marker_position (frame, marker, axis) [px]``, ``marker_position_sd``, ``marker_flag``.

    Returns
    -------
    Dataset
        ``time``, ``joint_angle (joint, frame)`` in the declared unit, ``joint_angle_covariance``,
        ``angle_flag``, with one joint.

    Raises
    ------
    Fault
        There are fewer than two dots, or the unit is neither an angle nor a length.
    """
    if markers.sizes["marker"] < 2:
        raise Fault("camera.dots: a motion needs two dots, the line from the first to the second")
    place = markers["marker_position"].transpose("frame", "marker", "axis").to_numpy()[:, :2]
    sd = markers["marker_position_sd"].transpose("frame", "marker").to_numpy()[:, :2]
    line = place[:, 1] - place[:, 0]
    length = np.hypot(*line.T)
    unit = campaign.specimen.motion.unit if campaign.specimen else "pixel"
    factor, turns = _find_scale(unit, campaign.camera.metres_per_pixel if campaign.camera else None)
    value = unwrap_array(np.arctan2(-line[:, 1], line[:, 0])) if turns else length
    variance = (sd**2).sum(axis=1) / (length**2 if turns else 1.0)
    flags = markers["marker_flag"].transpose("frame", "marker").to_numpy()[:, :2]
    flag = np.bitwise_or.reduce(flags, axis=1)
    return xr.Dataset(
        {
            "time": markers["time"],
            "joint_angle": (("joint", "frame"), factor * value[None]),
            "joint_angle_covariance": (
                ("frame", "joint", "other_joint"), (factor**2 * variance)[:, None, None],
            ),
            "angle_flag": (("joint", "frame"), flag.astype(np.uint8)[None]),
        },
        coords={"joint": [1], "other_joint": [1]},
    )  # fmt: skip


def _find_scale(unit: str, metres_per_pixel: float | None) -> tuple[float, bool]:
    """Factor from pixels or radians; if an angle's."""
    if "rad" in unit or "deg" in unit or "°" in unit:
        return find_factor("rad", unit), True
    if unit in ("px", "pixel"):
        return 1.0, False
    if metres_per_pixel is None:
        raise Fault(
            f"specimen.motion.unit is '{unit}', but camera.metres_per_pixel is missing; give it, "
            "or state the motion in pixel"
        )
    return metres_per_pixel * find_factor("m", unit), False
