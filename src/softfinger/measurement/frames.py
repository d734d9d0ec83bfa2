"""Which frames of a trial enter its likelihood.

It also gives how much each frame weighs.

Neighbouring joints share links, so their noise is correlated frame by frame: a frame counts when
every present joint of its trial was seen in it. A joint that was seen in less than half of the
frames in which some joint was seen is not present in that trial. One lost marker then does not
cost the others their frames.
"""

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from softfinger.faults import Fault
from softfinger.measurement.decisions import DECISIONS
from softfinger.units import select_units


def select_frames(angles: xr.Dataset) -> xr.Dataset:
    """Select the frames that enter each trial's likelihood.

    A frame's scale is the sd that its recording claims over the joint's median claim,
    root-mean-squared over joints: 1 where nothing is claimed.

    Parameters
    ----------
    angles
        The `angles` artifact: time (trial, frame) [s], joint_angle (trial, joint, frame) [rad],
        angle_flag (trial, joint, frame), joint_angle_covariance (trial, frame, joint, other_joint).

    Returns
    -------
    Dataset
        present (trial, joint); used (trial, frame), times of used frames strictly increasing;
        frame_scale (trial, frame) [1]; frame_interval () [s], the median over used frames.
        Its attributes are a specimen's units.

    Raises
    ------
    Fault
        If no trial has enough frames.
    """
    time = angles["time"].transpose("trial", "frame")
    angle = angles["joint_angle"].transpose("trial", "joint", "frame")
    flag = angles["angle_flag"].transpose("trial", "joint", "frame")
    seen = (np.isfinite(angle) & (flag == 0) & np.isfinite(time)).transpose(*angle.dims).values
    present = find_present_joints_array(seen)
    used = np.where(present[:, :, None], seen, True).all(axis=1) & present.any(axis=1)[:, None]
    used &= mark_advancing_array(time.values, used)
    enough = used.sum(axis=1) >= DECISIONS.least_frames
    if not enough.any():
        raise Fault(
            f"no trial has {DECISIONS.least_frames} frames in which its joints were seen: "
            "there is nothing to fit"
        )
    present &= enough[:, None]
    used &= enough[:, None]
    return xr.Dataset(
        {
            "present": (("trial", "joint"), present),
            "used": (("trial", "frame"), used),
            "frame_scale": (("trial", "frame"), compute_frame_scale(angles, used)),
            "frame_interval": ((), compute_frame_interval_array(time.values, used)),
        },
        coords={name: angles[name] for name in ("trial", "joint") if name in angles.coords},
        attrs=select_units(angles.attrs),
    )


def find_present_joints_array(seen: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Find which joints were seen often enough.

    From seen (trial, joint, frame) to (trial, joint).

    >>> find_present_joints_array(np.array([[[True, True, True], [False, False, True]]]))
    array([[ True, False]])
    """
    candidates = seen.any(axis=1).sum(axis=1)[:, None]
    return (seen.sum(axis=2) >= DECISIONS.least_share_seen * candidates) & (candidates > 0)


def mark_advancing_array(time: NDArray[np.float64], used: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Mark the used frames at which time advances.

    (trial, frame): the time lies after that of every earlier used frame.

    >>> mark_advancing_array(np.array([[0.0, 1.0, 1.0, 2.0]]), np.ones((1, 4), bool))
    array([[ True,  True, False,  True]])
    """
    clock = np.where(used, time, -np.inf)
    before = np.maximum.accumulate(clock, axis=1)
    earlier = np.concatenate([np.full((len(time), 1), -np.inf), before[:, :-1]], axis=1)
    return used & (clock > earlier)


def compute_frame_interval_array(time: NDArray[np.float64], used: NDArray[np.bool_]) -> float:
    """Compute the median interval [s] between used frames.

    The frames are neighbours; the median is over all trials.

    >>> compute_frame_interval_array(np.array([[0.0, 0.5, 1.0, 2.0]]), np.ones((1, 4), bool))
    0.5
    """
    return float(
        np.median(np.concatenate([np.diff(t[u]) for t, u in zip(time, used, strict=True)]))
    )


def compute_frame_scale(angles: xr.Dataset, used: NDArray[np.bool_]) -> NDArray[np.float64]:
    """Compute the relative claimed sd (trial, frame).

    It is the frame's claimed sd over the median claim of its joints.
    """
    covariance = angles["joint_angle_covariance"].transpose(
        "trial", "frame", "joint", "other_joint"
    )
    claimed = np.einsum("tfjj->tfj", covariance.values)
    claimed = np.where(used[..., None] & (claimed > 0), claimed, np.nan)
    if np.isnan(claimed).all():
        return np.ones(used.shape)
    median = np.array(
        [
            np.median(c[np.isfinite(c)]) if np.isfinite(c).any() else np.nan
            for c in np.moveaxis(claimed, 2, 0)
        ]
    )
    relative = claimed / median
    count = np.isfinite(relative).sum(axis=2)
    mean = np.nansum(relative, axis=2) / np.maximum(count, 1)
    return np.sqrt(np.where(count > 0, mean, 1.0))
