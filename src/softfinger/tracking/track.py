"""A video's markers: where each one is in every frame, with its standard deviation."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import chain
from pathlib import Path

import numpy as np
import xarray as xr

from softfinger.campaign import Camera, Campaign, marker_names
from softfinger.faults import TrialFault
from softfinger.progress import track_progress
from softfinger.tracking.detection import find_discs_array
from softfinger.tracking.disc import RADIUS, X
from softfinger.tracking.fit import FIT_QUALITY, VARIANCE_X, VARIANCE_Y
from softfinger.tracking.flags import MISSING
from softfinger.tracking.follow import follow_discs_array
from softfinger.tracking.identity import match_finger_array
from softfinger.tracking.recover import Body, recover_array
from softfinger.tracking.video import Frame, read_frames

POLARITY = {"dark": -1, "light": 1}
GREY = np.full(3, 1.0 / 3.0)


@dataclass
class Tracker:
    """What is known of each marker, from one picture to the next."""

    weight: np.ndarray
    polarity: int
    known: np.ndarray
    body: Body

    def __post_init__(self) -> None:
        self.velocity = np.zeros((len(self.known), 2))
        self.lost_for = np.zeros(len(self.known), int)

    def follow(self, picture: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Find every marker in the next picture; return parameters and qualities, NaN = not seen."""
        fitted = np.full_like(self.known, np.nan)
        quality = np.full((len(self.known), len(FIT_QUALITY)), np.nan)
        predicted = self.known[:, :2] + self.velocity
        self._fit(picture, self.lost_for == 0, predicted, fitted, quality)
        stretched = self.body.find_stretched(fitted[:, :2], self.known[:, RADIUS])
        fitted[stretched], quality[stretched] = np.nan, np.nan
        if np.isnan(fitted[:, X]).any():
            self._recover(picture, predicted, fitted, quality)
        seen = np.isfinite(fitted[:, X])
        fresh = seen & (self.lost_for == 0)
        self.velocity = np.where(fresh[:, None], fitted[:, :2] - self.known[:, :2], 0.0)
        self.known[seen] = fitted[seen]
        self.lost_for = np.where(seen, 0, self.lost_for + 1)
        return fitted, quality

    def _fit(
        self,
        picture: np.ndarray,
        wanted: np.ndarray,
        predicted: np.ndarray,
        fitted: np.ndarray,
        quality: np.ndarray,
    ) -> None:
        """Fit the wanted markers; the others keep what they have."""
        found = wanted.copy()
        fit, measured = np.empty_like(fitted), np.empty_like(quality)
        follow_discs_array(picture, self.weight, self.known, found, predicted, fit, measured)
        fitted[found], quality[found] = fit[found], measured[found]

    def _recover(
        self, picture: np.ndarray, predicted: np.ndarray, fitted: np.ndarray, quality: np.ndarray
    ) -> None:
        radius = self.known[:, RADIUS]
        discs = find_discs_array(picture, self.weight, float(np.median(radius)), self.polarity)
        chosen = recover_array(
            self.body, fitted[:, :2], predicted, radius, self.lost_for, discs[:, :2]
        )
        wanted = np.zeros(len(self.known), bool)
        for marker, disc in chosen.items():
            wanted[marker] = True
            predicted[marker] = discs[disc, :2]
        self._fit(picture, wanted, predicted, fitted, quality)
        stretched = self.body.find_stretched(fitted[:, :2], radius)
        fitted[stretched], quality[stretched] = np.nan, np.nan


def track_video(path: Path, camera: Camera, link_length: Sequence[float]) -> xr.Dataset:
    """Track the declared markers through one trial's video.

    Parameters
    ----------
    path : Path
        The video; frames are streamed.
    camera : Camera
        Frame rate, scale, and the markers' places, size and colour.
    link_length : sequence [m]
        Joint centre to joint centre, base to tip.

    Returns
    -------
    Dataset
        ``time (frame) [s]``, ``marker_position (frame, marker, axis) [px]``, NaN where not seen,
        ``marker_position_sd (frame, marker) [px]``, ``marker_flag (frame, marker)``.

    Raises
    ------
    TrialFault
        The video cannot be used (see :func:`softfinger.tracking.video.read_frames`), or the
        markers are never found.
    """
    frames = read_frames(path, camera.fps)
    before, first, tracker = _start(path, frames, camera, link_length)
    times = list(before)
    empty = np.full((len(tracker.known), 3), np.nan)
    fits = [empty for _ in before]
    for frame in chain([first], frames):
        fitted, quality = tracker.follow(frame.picture)
        variance = 0.5 * (quality[:, VARIANCE_X] + quality[:, VARIANCE_Y])
        fits.append(np.column_stack([fitted[:, :2], np.sqrt(variance)]))
        times.append(frame.time)
    table = np.array(fits)
    flag = np.where(np.isfinite(table[..., 0]), 0, MISSING).astype(np.uint8)
    return xr.Dataset(
        {
            "time": ("frame", np.array(times)),
            "marker_position": (("frame", "marker", "axis"), table[..., :2]),
            "marker_position_sd": (("frame", "marker"), table[..., 2]),
            "marker_flag": (("frame", "marker"), flag),
        },
        coords={"marker": marker_names(camera), "axis": ["x", "y"]},
    )


def _start(
    path: Path, frames: Iterator[Frame], camera: Camera, link_length: Sequence[float]
) -> tuple[list[float], Frame, Tracker]:
    """Go to the first frame that shows every marker; return the times before it as well."""
    radius = 0.5 * camera.marker_diameter_m / camera.metres_per_pixel
    polarity = POLARITY.get(camera.marker_colour or "", 0)
    before: list[float] = []
    most = 0
    for frame in frames:
        weight = GREY if frame.picture.shape[2] == 3 else np.ones(1)
        discs = find_discs_array(frame.picture, weight, radius, polarity)
        most = max(most, len(discs))
        matches = match_finger_array(
            discs[:, :2], camera.markers, link_length, camera.metres_per_pixel, 0.5 * radius
        )
        if matches:
            known = discs[list(matches[0].disc)]
            body = Body.measure(_list_links(camera), known[:, :2])
            return before, frame, Tracker(weight, polarity, known, body)
        before.append(frame.time)
    raise TrialFault(
        f"{path.name}: the {len(marker_names(camera))} declared markers are in none of its "
        f"{len(before)} frames (at most {most} discs of radius {radius:.1f} px were found); check "
        "camera.metres_per_pixel, marker_diameter_m, markers and marker_colour in campaign.yaml"
    )


def _list_links(camera: Camera) -> list[list[int]]:
    names = [name.rsplit("_", 1)[0] for name in marker_names(camera)]
    return [[k for k, own in enumerate(names) if own == link] for link in dict.fromkeys(names)]


def track_trials(campaign: Campaign, trials: Sequence[str]) -> xr.Dataset:
    """Track a batch of filmed trials into one `markers` artifact.

    Parameters
    ----------
    campaign : Campaign
    trials : sequence of str
        Names of trials that have a video.

    Returns
    -------
    Dataset
        As :func:`track_video` with a dim ``trial`` before, padded with NaN, and
        ``set_aside_reason (trial)``: why a trial cannot be used, "" = it can.
    """
    wanted = {trial.name: trial for trial in campaign.trials}
    tracked, reasons = [], []
    for name in track_progress(trials, "tracking videos"):
        try:
            tracked.append(
                track_video(wanted[name].recording, campaign.camera, campaign.finger.link_length_m)
            )
            reasons.append("")
        except TrialFault as fault:
            tracked.append(_build_empty(campaign.camera))
            reasons.append(str(fault))
    padded = xr.concat(
        [_pad(one, max(t.sizes["frame"] for t in tracked)) for one in tracked],
        dim=xr.DataArray(np.asarray(trials, dtype=object), dims="trial", name="trial"),
    )
    return padded.assign(set_aside_reason=("trial", np.asarray(reasons, dtype=object)))


def _build_empty(camera: Camera) -> xr.Dataset:
    names = marker_names(camera)
    return xr.Dataset(
        {
            "time": ("frame", np.empty(0)),
            "marker_position": (("frame", "marker", "axis"), np.empty((0, len(names), 2))),
            "marker_position_sd": (("frame", "marker"), np.empty((0, len(names)))),
            "marker_flag": (("frame", "marker"), np.empty((0, len(names)), np.uint8)),
        },
        coords={"marker": names, "axis": ["x", "y"]},
    )


def _pad(one: xr.Dataset, length: int) -> xr.Dataset:
    return one.pad(
        frame=(0, length - one.sizes["frame"]),
        constant_values={
            "time": np.nan,
            "marker_position": np.nan,
            "marker_position_sd": np.nan,
            "marker_flag": MISSING,
        },
    )
