"""Number, resolution and tracking quality of recordings."""

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from softfinger.measurement.flags import JUMP, MISSING, STALE
from softfinger.summary.residuals import list_load_jumps, select_good

FLAGS = {"missing": MISSING, "stale": STALE, "jump": JUMP}
"""Bits of `angle_flag`."""


def summarise_recordings(angles: xr.Dataset) -> xr.Dataset:
    """Summarise lengths, loads and flags of the trials.

    Returns
    -------
    Dataset
        trial_duration [s], trial_frames, trial_load (the largest), trial_flagged (trial);
        flag_share (flag); frame_interval, duration (the last frame's interval included) [s],
        angle_range [rad], frames, one_load (); spread_error (), the least relative error that so
        few trials leave of a spread, NaN of one trial.
    """
    time = angles["time"].transpose("trial", "frame")
    inside = time.notnull()
    interval = float(np.nanmedian(np.diff(time.values, axis=1)))
    recorded = angles["joint_angle"].where(select_good(angles))
    cells = int(inside.sum()) * angles.sizes["joint"]
    shares = [int((((angles["angle_flag"] & bit) > 0) & inside).sum()) for bit in FLAGS.values()]
    n = angles.sizes["trial"]
    return xr.Dataset(
        {
            "trial_duration": time.max("frame"),
            "trial_frames": inside.sum("frame"),
            "trial_load": ("trial", find_largest_load(angles)),
            "trial_flagged": (angles["angle_flag"] > 0).where(inside).mean(("joint", "frame")),
            "flag_share": ("flag", np.array(shares) / cells),
            "frame_interval": ((), interval),
            "duration": ((), float(time.max()) + interval),
            "frames": ((), int(inside.sum())),
            "angle_range": recorded.max() - recorded.min(),
            "one_load": ((), has_one_load(angles)),
            "spread_error": ((), 1 / np.sqrt(2 * (n - 1)) if n > 1 else np.nan),
        },
        coords={"trial": angles["trial"].values, "flag": list(FLAGS)},
    )


def find_largest_load(angles: xr.Dataset) -> NDArray[np.float64]:
    """Each trial's (trial,) largest load, signed."""
    load = angles["load_torque"].transpose("trial", "knot").values
    return np.take_along_axis(load, np.abs(load).argmax(axis=1)[:, None], axis=1)[:, 0]


def has_one_load(angles: xr.Dataset) -> bool:
    """Whether every trial has one lasting step."""
    knots = zip(angles["load_time"].values, angles["load_torque"].values, strict=True)
    return all(
        len(list_load_jumps(time, load)) == 1
        and np.ptp(load[load != 0]) <= 1e-6 * np.abs(load).max()
        for time, load in knots
    )


def summarise_tracking(quality: xr.Dataset) -> xr.Dataset:
    """Take each trial's worst marker from `tracking_quality`."""
    return xr.Dataset(
        {
            "share_seen": quality["share_seen"].min("marker"),
            "share_suspect": quality["share_suspect"].max("marker"),
            "share_stale": quality["share_stale"],
            "sd": quality["sd_median"].max("marker"),
            "rigid_residual": quality["rigid_residual"].max("marker"),
        }
    )


def choose_frame(markers: xr.Dataset, picture: xr.Dataset | None) -> xr.Dataset:
    """Choose the frame that the tracking figure shows.

    Returns
    -------
    Dataset
        trial, frame (): those of the picture, else the last of the first trial that is used;
        sd () [px], the median of a coordinate over that trial.
    """
    if picture is None:
        place = int(np.argmax(markers["set_aside_reason"].values.astype(str) == ""))
        trial = str(markers["trial"].values[place])
        frame = int(np.flatnonzero(np.isfinite(markers["time"].values[place]))[-1])
    else:
        trial, frame = str(picture["trial"].item()), int(picture["frame"].item())
    sd = float(np.nanmedian(markers["marker_position_sd"].sel(trial=trial)))
    return xr.Dataset({"trial": ((), trial), "frame": ((), frame), "sd": ((), sd)})
