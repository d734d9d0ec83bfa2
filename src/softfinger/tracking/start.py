"""First picture with every marker, and their discs."""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from softfinger.campaign import Camera, marker_names
from softfinger.faults import TrialFault
from softfinger.tracking.appearance import (
    choose_polarity,
    choose_weight,
    draw_closeness,
    measure_light,
)
from softfinger.tracking.body import Body
from softfinger.tracking.camera import undistort_array
from softfinger.tracking.detection import find_discs_array
from softfinger.tracking.disc import CONTRAST, LEVEL, PARAMETERS, RADIUS, SPREAD, X, Y
from softfinger.tracking.fit import FIT_QUALITY
from softfinger.tracking.follow import choose_margins_array, follow_discs_array
from softfinger.tracking.identity import Match, match_finger_array
from softfinger.tracking.tracker import Tracker
from softfinger.tracking.video import Frame, peek_pictures

_TOLERANCE = 0.5  # radii between a disc and where the finger's geometry puts it
_UNKNOWN_RADII = tuple(2.5 * 1.5**k for k in range(7))  # px, where no scale is declared
_UNKNOWN_SCALES = (1.0, 0.95, 1.05, 0.9, 1.1)  # what a declared diameter may be off by
_CLEARLY_WORSE, _ALMOST_EXACT = 5.0, 0.05  # best error, and radii: what is worse is no rival
_NEAR_ENOUGH = 128.0  # of 255, to a declared colour
_EVERY_FRAME, _THEN_EVERY = 30, 10
_PEEKS = (0.5, 1.0)


@dataclass(frozen=True)
class Sighting:
    """All markers named in one picture."""

    match: Match
    discs: np.ndarray  # (disc, 8)
    scale: float  # m/px

    @property
    def markers(self) -> np.ndarray:
        """Discs in the order of the markers (marker, 8)."""
        return self.discs[list(self.match.disc)]


def find_start(
    path: Path, frames: Iterator[Frame], camera: Camera, link_length: Sequence[float]
) -> tuple[list[float], Frame, Tracker]:
    """Go to the first frame that shows every marker.

    Returns
    -------
    times of the frames before it [s], the frame itself, a tracker that starts there

    Raises
    ------
    TrialFault
        No frame shows the declared markers.
    """
    before: list[float] = []
    most, shape = 0, (0, 0)
    for frame in frames:
        shape = frame.picture.shape
        if frame.index < _EVERY_FRAME or frame.index % _THEN_EVERY == 0:
            sightings, count = list_sightings(frame.picture, camera, link_length)
            most = max(most, count)
            if sightings:
                chosen = _choose(sightings, path, camera, link_length)
                return before, frame, _build_tracker(frame.picture, chosen, camera, link_length)
        before.append(frame.time)
    scaled = camera.metres_per_pixel is not None
    size = f" of radius {_list_radii(camera)[0]:.1f} px" if scaled else ""
    raise TrialFault(
        f"{path.name}: none of its {len(before)} frames of {shape[1]} × {shape[0]} px shows the "
        f"{len(marker_names(camera))} declared markers (at most {most} discs{size} in one); check "
        "marker_colour, marker_diameter_m, metres_per_pixel and markers in campaign.yaml"
    )


def start_at_points(picture: np.ndarray, places: np.ndarray, radius: float | np.ndarray) -> Tracker:
    """Tracker of independent discs near given places.

    No geometry binds them.

    Parameters
    ----------
    picture : (row, column, channel)
    places : (marker, 2) [px]
    radius : float or (marker,) [px]
        About the discs' radius.
    """
    rough = np.zeros((len(places), len(PARAMETERS)))
    rough[:, [X, Y]] = places
    rough[:, RADIUS], rough[:, SPREAD] = radius, 0.1 * np.asarray(radius)
    weight = np.full(picture.shape[2], 1.0 / picture.shape[2])
    known = measure_light(picture, weight, rough)
    links = [[k] for k in range(len(places))]
    margin = choose_margins_array(picture, weight, known)
    return Tracker(weight, known, Body.measure(links, known[:, :2]), margin)


def locate_discs(picture: np.ndarray, radius: float, colour: str | None = None) -> np.ndarray:
    """Discs of a radius and colour (:func:`measure_discs`)."""
    return measure_discs(picture, radius, colour)[0]


def measure_discs(
    picture: np.ndarray, radius: float, colour: str | None = None
) -> tuple[np.ndarray, np.ndarray]:
    """Discs of a radius and colour, with fit quality.

    Parameters
    ----------
    picture : (row, column, channel)
    radius : float [px]
    colour : str, optional
        ``dark``, ``light`` or ``#rrggbb``; either polarity where none is given.

    Returns
    -------
    discs : numpy.ndarray (disc, 8)
        Parameters of :data:`softfinger.tracking.disc.PARAMETERS`, in the mix of channels in which
        the discs are clearest.
    quality : numpy.ndarray (disc, 5)
        As :data:`softfinger.tracking.fit.FIT_QUALITY`.
    """
    coloured = (colour or "").startswith("#") and picture.shape[2] == 3
    view = draw_closeness(picture, str(colour)) if coloured else picture
    weight = np.full(view.shape[2], 1.0 / view.shape[2])
    discs = find_discs_array(view, weight, radius, choose_polarity(colour))
    if coloured:
        discs = discs[discs[:, LEVEL] + discs[:, CONTRAST] > _NEAR_ENOUGH]
    weight = choose_weight(picture, discs)
    known = measure_light(picture, weight, discs)
    refined = np.full_like(known, np.nan)
    quality = np.empty((len(known), len(FIT_QUALITY)))
    margin, wanted = choose_margins_array(picture, weight, known), np.ones(len(known), bool)
    places = known[:, :2].copy()
    follow_discs_array(picture, weight, known, margin, wanted, places, refined, quality)
    found = np.isfinite(refined[:, X])
    return refined[found], quality[found]


def list_sightings(
    picture: np.ndarray, camera: Camera, link_length: Sequence[float]
) -> tuple[list[Sighting], int]:
    """Ways to find the declared markers, best first.

    Returns
    -------
    sightings, largest number of discs found
    """
    sightings: list[Sighting] = []
    most = 0
    for radius in _list_radii(camera):
        discs = locate_discs(picture, radius, camera.marker_colour)
        most = max(most, len(discs))
        straight = undistort_array(discs[:, :2], camera)
        for scale in _list_scales(camera, discs):
            matches = match_finger_array(
                straight, camera.markers, link_length, scale, _TOLERANCE * radius
            )
            sightings += [Sighting(match, discs, scale) for match in matches]
    return sorted(sightings, key=lambda s: s.match.error), most


def _list_radii(camera: Camera) -> Sequence[float]:
    if camera.metres_per_pixel is None:
        return _UNKNOWN_RADII
    return (0.5 * camera.marker_diameter_m / camera.metres_per_pixel,)


def _list_scales(camera: Camera, discs: np.ndarray) -> Iterable[float]:
    if camera.metres_per_pixel is not None:
        return (camera.metres_per_pixel,)
    if len(discs) < len(marker_names(camera)):
        return ()
    typical = 0.5 * camera.marker_diameter_m / float(np.median(discs[:, RADIUS]))
    return [typical * factor for factor in _UNKNOWN_SCALES]


def _choose(
    sightings: Sequence[Sighting], path: Path, camera: Camera, link_length: Sequence[float]
) -> Sighting:
    """The sighting whose base stays, as geometry allows."""
    best = sightings[0]
    radius = float(np.median(best.markers[:, RADIUS]))
    limit = _CLEARLY_WORSE * best.match.error + _ALMOST_EXACT * radius
    rivals = [s for s in sightings if s.match.error < limit]
    if len(rivals) == 1:
        return best
    base = len(camera.markers["base"])
    later = [
        np.array([s.markers[:base, :2] for s in list_sightings(p, camera, link_length)[0]])
        for p in peek_pictures(path, _PEEKS)
    ]

    def rate(sighting: Sighting) -> float:
        moved = [
            np.hypot(*np.moveaxis(found - sighting.markers[:base, :2], -1, 0)).max(axis=1).min()
            for found in later
            if len(found)
        ]
        return sighting.match.error + sum(moved)

    return min(rivals, key=rate)


def _build_tracker(
    picture: np.ndarray, chosen: Sighting, camera: Camera, link_length: Sequence[float]
) -> Tracker:
    weight = choose_weight(picture, chosen.markers)
    known = measure_light(picture, weight, chosen.markers)
    names = [name.rsplit("_", 1)[0] for name in marker_names(camera)]
    groups = list(dict.fromkeys(names))
    links = [[k for k, own in enumerate(names) if own == link] for link in groups]
    ends = [0.0, *link_length]
    joint = np.array(
        [(ends[k] - camera.markers[link][-1]) / chosen.scale for k, link in enumerate(groups)]
    )
    arm = np.array([place for link in groups for place in camera.markers[link]]) / chosen.scale
    body = Body.measure(links, known[:, :2], joint, arm)
    return Tracker(weight, known, body, choose_margins_array(picture, weight, known))
