"""Every frame's markers, with their sd."""

from collections.abc import Sequence
from itertools import chain
from pathlib import Path

import numpy as np
import xarray as xr

from softfinger.campaign import Camera, Campaign, marker_names
from softfinger.faults import TrialFault
from softfinger.measurement.flags import JUMP, MISSING, STALE
from softfinger.progress import track_progress
from softfinger.tracking.body import Body
from softfinger.tracking.disc import RADIUS, X, Y
from softfinger.tracking.dots import start_dots
from softfinger.tracking.fit import FIT_QUALITY
from softfinger.tracking.start import find_start
from softfinger.tracking.uncertainty import claim_sd_array, compute_excess_array
from softfinger.tracking.video import read_frames

_SUSPECT_EXCESS = 4.0  # residual over the typical one: something else is in the window


def track_video(
    path: Path, camera: Camera, link_length: Sequence[float] | None = None
) -> xr.Dataset:
    """Track the declared markers through one trial's video.

    Parameters
    ----------
    path : Path
        The video; frames are streamed.
    camera : Camera
        Frame rate, scale, and the markers' places, size and colour.
    link_length : sequence [m], optional
        Joint centre to joint centre, base to tip; free dots need none.

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
    if camera.dots:
        before, first, tracker = start_dots(frames, camera.dots)
    else:
        before, first, tracker = find_start(path, frames, camera, link_length or ())
    times = list(before)
    fits = [np.full((len(tracker.known), 2 + len(FIT_QUALITY)), np.nan) for _ in before]
    stale = [False for _ in before]
    last: list[np.ndarray] = []
    for frame in chain([first], frames):
        fitted, quality = tracker.follow(frame.picture)
        windows = cut_patches(frame.picture, tracker.known)
        stale.append(bool(last) and all(map(np.array_equal, windows, last)))
        last = windows
        fits.append(np.column_stack([fitted[:, :2], quality]))
        times.append(frame.time)
    table = np.array(fits)
    return _describe(camera, np.array(times), table, np.array(stale), tracker.body)


def cut_patches(picture: np.ndarray, discs: np.ndarray) -> list[np.ndarray]:
    """Pixels around discs; equal only in repeated frames."""
    windows = []
    for disc in discs:
        reach = disc[RADIUS] + 2.0
        top, left = max(0, int(disc[Y] - reach)), max(0, int(disc[X] - reach))
        bottom, right = max(0, int(disc[Y] + reach)), max(0, int(disc[X] + reach))
        windows.append(picture[top:bottom, left:right].copy())
    return windows


def _describe(
    camera: Camera, time: np.ndarray, table: np.ndarray, stale: np.ndarray, body: Body
) -> xr.Dataset:
    position, quality = table[..., :2], table[..., 2:]
    sd = claim_sd_array(position, quality, stale, body)
    seen = np.isfinite(position[..., 0])
    flag = np.where(seen, 0, MISSING) | np.where(stale[:, None], STALE, 0)
    flag |= np.where(compute_excess_array(quality) > _SUSPECT_EXCESS, JUMP, 0)
    return xr.Dataset(
        {
            "time": ("frame", time),
            "marker_position": (("frame", "marker", "axis"), position),
            "marker_position_sd": (("frame", "marker"), sd),
            "marker_flag": (("frame", "marker"), flag.astype(np.uint8)),
        },
        coords={"marker": marker_names(camera), "axis": ["x", "y"]},
    )


def track_trials(campaign: Campaign, trials: Sequence[str]) -> xr.Dataset:
    """Track a batch of filmed trials: artifact `markers`.

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
