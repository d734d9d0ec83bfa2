"""Noise of recordings that are planned."""

import numpy as np
import xarray as xr

from softfinger.measurement.frames import select_frames
from softfinger.measurement.measure import LAYOUT


def assume_noise(angles: xr.Dataset, known: xr.Dataset) -> xr.Dataset:
    """Take the noise of all joints from another campaign.

    Of recordings that are planned: all of their frames count, and nothing is wrong with them.
    """
    frames = select_frames(angles)
    none, ones = xr.zeros_like(frames["used"]), np.ones([angles.sizes[dim] for dim in LAYOUT])
    shared = known.drop_dims("trial").drop_vars("frame_interval")
    return frames.assign(
        repeated=none,
        saturated=none,
        outlier_distance=none.astype(float),
        trial_factor=(LAYOUT[:2], ones[:, :, 0]),
        noise_factor=(LAYOUT, ones),
        **shared.data_vars,
    )
