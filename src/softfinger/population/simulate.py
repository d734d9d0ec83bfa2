"""Recordings drawn from the model itself: for predictions, calibration and design."""

from collections.abc import Sequence

import numpy as np
import xarray as xr
from numba import njit
from numpy.typing import NDArray

from softfinger.mechanics.three_element import compute_joint_angle_array
from softfinger.population.covariance import compute_innovation_covariance_array

PARAMETERS = ("k_v", "c_v", "c_p", "q_ini")


def build_recording(
    time: NDArray[np.float64],
    load_time: NDArray[np.float64],
    load_torque: NDArray[np.float64],
    joints: int,
    trials: Sequence[str],
) -> xr.Dataset:
    """Build the `angles` of a campaign that has times and loads but not yet any angle.

    Parameters
    ----------
    time
        (frame,) or (trial, frame) [s], rows may end in NaN.
    load_time, load_torque
        (knot,) or (trial, knot) [s], [N m].
    joints
        How many.
    trials
        Their names.
    """
    n = len(trials)
    time, load_time, load_torque = (
        np.broadcast_to(a, (n, np.shape(a)[-1])) for a in (time, load_time, load_torque)
    )
    shape = (n, joints, time.shape[1])
    covariance = np.full((n, time.shape[1], joints, joints), np.nan)
    return xr.Dataset(
        {
            "time": (("trial", "frame"), time),
            "joint_angle": (("trial", "joint", "frame"), np.full(shape, np.nan)),
            "angle_flag": (("trial", "joint", "frame"), np.zeros(shape, np.uint8)),
            "joint_angle_covariance": (("trial", "frame", "joint", "other_joint"), covariance),
            "load_time": (("trial", "knot"), load_time),
            "load_torque": (("trial", "knot"), load_torque),
            "load_kind": ("trial", ["torque_nm"] * n),
        },
        coords={"trial": list(trials), "joint": np.arange(1, joints + 1)},
        attrs={"noise_sd_rad": np.nan},
    )


def compute_motion(angles: xr.Dataset, parameters: xr.Dataset) -> xr.DataArray:
    """Compute the angles (…, trial, joint, frame) [rad] that parameters (…, trial, joint) cause."""
    order = [name for name in parameters["k_v"].dims if name not in ("trial", "joint")]
    order += ["trial", "joint"]
    values = [parameters[name].transpose(*order).values for name in PARAMETERS]
    series = [
        angles[name].transpose("trial", ...).values[:, None, :]
        for name in ("time", "load_time", "load_torque")
    ]
    motion = compute_joint_angle_array(*values, *series)
    coords = {name: parameters[name] for name in order if name in parameters.coords}
    return xr.DataArray(motion, dims=[*order, "frame"], coords=coords, name="joint_angle")


def draw_angles(
    angles: xr.Dataset, parameters: xr.Dataset, noise: xr.Dataset, rng: np.random.Generator
) -> xr.Dataset:
    """Draw what a camera would record of trials with known parameters.

    Parameters
    ----------
    angles
        Times, loads and flags; its angles are not read.
    parameters
        k_v, c_v, c_p, q_ini (trial, joint).
    noise
        noise_sd, noise_autocorrelation (joint) per median interval, noise_correlation
        (joint, other_joint).
    rng
        Source of the noise.

    Returns
    -------
    Dataset
        `angles` with joint_angle replaced; flagged frames hold angles as well.
    """
    time = angles["time"].transpose("trial", "frame").values
    interval = float(np.nanmedian(np.diff(time, axis=1)))
    motion = compute_motion(angles, parameters).transpose("trial", "joint", "frame")
    noisy = motion.values + np.stack([draw_noise_array(row / interval, noise, rng) for row in time])
    return angles.assign(joint_angle=(motion.dims, noisy))


def draw_noise_array(
    time: NDArray[np.float64], noise: xr.Dataset, rng: np.random.Generator
) -> NDArray[np.float64]:
    """Draw the noise (joint, frame) [rad] of one trial at times (frame,) in median intervals."""
    sd = noise["noise_sd"].values
    rho = noise["noise_autocorrelation"].values
    correlation = noise["noise_correlation"].values
    gap = np.diff(time, prepend=-np.inf)
    kinds, index = np.unique(np.round(gap, 9), return_inverse=True)
    factor = np.full((len(kinds), len(sd), len(sd)), np.nan)
    carried = np.full((len(kinds), len(sd)), np.nan)
    for k in np.flatnonzero(kinds > 0):
        covariance = compute_innovation_covariance_array(kinds[k], sd, rho, correlation)
        factor[k] = np.linalg.cholesky(covariance)
        carried[k] = rho ** kinds[k]
    normal = rng.standard_normal((time.size, len(sd)))
    return _accumulate(normal, factor, carried, index).T


@njit(cache=True)
def _accumulate(normal: NDArray, factor: NDArray, carried: NDArray, index: NDArray) -> NDArray:
    noise = np.empty_like(normal)
    state = np.zeros(normal.shape[1])
    for i in range(normal.shape[0]):
        state = carried[index[i]] * state + factor[index[i]] @ normal[i]
        noise[i] = state
    return noise
