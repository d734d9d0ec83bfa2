"""The report's picture of the finger, with markers."""

import cv2
import numpy as np
import xarray as xr

from softfinger.campaign import Campaign
from softfinger.faults import Fault
from softfinger.tracking.video import read_frames


def take_picture(campaign: Campaign, markers: xr.Dataset) -> xr.Dataset:
    """Frame of the most bent finger, first used trial.

    Parameters
    ----------
    campaign : Campaign
    markers : Dataset
        The artifact `markers` of some of its trials.

    Returns
    -------
    Dataset
        ``picture (row, column, channel)``, red, green, blue, 0 to 255, with scalar coords
        ``trial`` and ``frame``.

    Raises
    ------
    Fault
        Every one of the trials is set aside.
    """
    used = np.flatnonzero(markers["set_aside_reason"].to_numpy().astype(str) == "")
    if not used.size:
        raise Fault("no trial of this batch was tracked, so it has no picture to show")
    one = markers.isel(trial=used[0])
    name, wanted = str(one["trial"].item()), find_most_bent(one)
    trial = next(trial for trial in campaign.trials if trial.name == name)
    for frame in read_frames(trial.recording, campaign.camera.fps):
        if frame.index == wanted:
            return _describe(frame.picture, name, wanted)
    raise Fault(
        f"{trial.recording}: frame {wanted} is missing, and was there when the video was "
        "tracked; run `track` again"
    )


def find_most_bent(markers: xr.Dataset) -> int:
    """Frame in which a trial's markers moved farthest.

    Among frames in which as many markers are seen as in any.

    Examples
    --------
    >>> x = np.zeros((4, 2, 2))
    >>> x[1, 0, 0], x[2, 1, 1], x[3] = 3.0, 5.0, np.nan
    >>> find_most_bent(xr.Dataset({"marker_position": (("frame", "marker", "axis"), x)}))
    2
    """
    position = markers["marker_position"].transpose("frame", "marker", "axis").to_numpy()
    seen = np.isfinite(position).all(axis=-1)
    distance = np.nansum((position - position[seen.sum(axis=1).argmax()]) ** 2, axis=(1, 2))
    return int(np.argmax(np.where(seen.sum(axis=1) == seen.sum(axis=1).max(), distance, -1.0)))


def _describe(picture: np.ndarray, trial: str, frame: int) -> xr.Dataset:
    grey = picture.shape[2] == 1
    colours = cv2.cvtColor(picture, cv2.COLOR_GRAY2RGB if grey else cv2.COLOR_BGR2RGB)
    return xr.Dataset(
        {"picture": (("row", "column", "channel"), colours)},
        coords={"trial": trial, "frame": frame, "channel": ["red", "green", "blue"]},
    )
