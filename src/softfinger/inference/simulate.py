"""Recordings drawn from the model itself."""

from collections.abc import Sequence

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from softfinger.compiled import compiled
from softfinger.measurement.covariance import compute_innovation_covariance_array
from softfinger.mechanics import PARAMETERS
from softfinger.mechanics.three_element import compute_joint_angle_array

LINK = ("length", "mass", "centre", "inertia")


def build_recording(
    time: NDArray[np.float64],
    load_time: NDArray[np.float64],
    load_torque: NDArray[np.float64],
    joints: int,
    trials: Sequence[str],
) -> xr.Dataset:
    """Build the `angles` of a campaign without angles.

    Its geometry is not declared.

    Parameters
    ----------
    time
        (frame,) or (trial, frame) [s], rows may end in NaN.
    load_time, load_torque
        (knot,) or (trial, knot) [s], [N m].
    """
    n = len(trials)
    time, load_time, load_torque = (
        np.broadcast_to(a, (n, np.shape(a)[-1])).copy() for a in (time, load_time, load_torque)
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
            "started_at": ("trial", np.full(n, np.nan)),
            **{f"link_{k}": ("joint", np.full(joints, np.nan)) for k in LINK},
            "joint_length": ((), np.nan),
            "wire_offset": ((), np.nan),
        },
        coords={"trial": list(trials), "joint": np.arange(1, joints + 1)},
        attrs={"noise_sd_rad": np.nan, "campaign": "drawn"},
    )


def draw_parameters(
    mean: NDArray[np.float64],
    sd: NDArray[np.float64],
    recording: xr.Dataset,
    rng: np.random.Generator,
) -> xr.Dataset:
    """Draw every trial's parameters from a population.

    Parameters
    ----------
    mean, sd
        (joint, 4) or (4,): of log k_v, log c_v, log c_p and q_ini.
    recording
        Gives trial and joint.

    Returns
    -------
    Dataset
        k_v, c_v, c_p, q_ini (trial, joint).
    """
    shape = (recording.sizes["trial"], recording.sizes["joint"], 4)
    drawn = mean + sd * rng.standard_normal(shape)
    drawn[..., :3] = np.exp(drawn[..., :3])
    coords = {name: recording[name] for name in ("trial", "joint")}
    values = {name: (("trial", "joint"), drawn[..., k]) for k, name in enumerate(PARAMETERS)}
    return xr.Dataset(values, coords)


def describe_noise(
    sd: NDArray[np.float64], autocorrelation: NDArray[np.float64], neighbours: float = 0.0
) -> xr.Dataset:
    """Describe noise for `draw_angles`.

    σ and ρ (joint,), and the correlation of neighbouring joints.
    """
    joints = len(sd)
    beside = np.eye(joints, k=1) + np.eye(joints, k=-1)
    return xr.Dataset(
        {
            "noise_sd": ("joint", np.asarray(sd, float)),
            "noise_autocorrelation": ("joint", np.asarray(autocorrelation, float)),
            "noise_white": ("joint", np.zeros(joints)),
            "noise_correlation": (("joint", "other_joint"), np.eye(joints) + neighbours * beside),
        }
    )


def compute_motion(angles: xr.Dataset, parameters: xr.Dataset) -> xr.DataArray:
    """Compute the angles (…, trial, joint, frame) [rad].

    Parameters (…, trial, joint) cause them.
    """
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
    """Draw what a camera would record.

    Parameters
    ----------
    angles
        Times, loads and flags; its angles are not read.
    parameters
        k_v, c_v, c_p, q_ini (trial, joint).
    noise
        noise_sd, noise_autocorrelation (joint) per median interval, noise_white (joint),
        noise_correlation (joint, other_joint).

    Returns
    -------
    Dataset
        `angles` with joint_angle replaced; flagged frames contain angles as well.
    """
    time = angles["time"].transpose("trial", "frame").values
    interval = float(np.nanmedian(np.diff(time, axis=1)))
    motion = compute_motion(angles, parameters).transpose("trial", "joint", "frame")
    noisy = motion.values.copy()
    for rows, clock in group_clocks(time / interval):
        noisy[rows] += draw_noise_array(clock, noise, len(rows), rng)
    return angles.assign(joint_angle=(motion.dims, noisy))


def group_clocks(
    time: NDArray[np.float64],
) -> list[tuple[NDArray[np.int64], NDArray[np.float64]]]:
    """Group trials (trial, frame) of the same times."""
    _, first, index = np.unique(
        np.nan_to_num(time, nan=-1.0), axis=0, return_index=True, return_inverse=True
    )
    return [(np.flatnonzero(index.ravel() == k), time[row]) for k, row in enumerate(first)]


def draw_noise_array(
    time: NDArray[np.float64], noise: xr.Dataset, trials: int, rng: np.random.Generator
) -> NDArray[np.float64]:
    """Draw the noise (trial, joint, frame) [rad].

    Parameters
    ----------
    time
        (frame,) in median frame intervals, may end in NaN; NaN there.
    noise
        As for `draw_angles`.
    """
    sd, white = noise["noise_sd"].values, noise["noise_white"].values
    rho, lasting = noise["noise_autocorrelation"].values, sd * np.sqrt(1.0 - white)
    correlation = noise["noise_correlation"].values
    known = np.isfinite(time)
    kinds, index = np.unique(
        np.round(np.diff(time[known], prepend=-np.inf), 9), return_inverse=True
    )
    covariance = [compute_innovation_covariance_array(g, lasting, rho, correlation) for g in kinds]
    factor = np.linalg.cholesky(np.stack(covariance))
    normal = rng.standard_normal((trials, index.size, len(sd)))
    drawn = np.full((trials, len(sd), time.size), np.nan)
    drawn[:, :, known] = _accumulate(normal, factor, rho ** kinds[:, None], index)
    if white.any():
        fresh = np.linalg.cholesky(correlation) @ rng.standard_normal((trials, len(sd), time.size))
        drawn += (sd * np.sqrt(white))[:, None] * fresh
    return drawn


@compiled(error_model="numpy")
def _accumulate(normal: NDArray, factor: NDArray, carried: NDArray, index: NDArray) -> NDArray:
    trials, frames, joints = normal.shape
    noise = np.empty((trials, joints, frames))
    state = np.zeros(joints)
    for t in range(trials):
        state[:] = 0.0
        for i in range(frames):
            kind = index[i]
            for j in range(joints):
                state[j] *= carried[kind, j]
                for k in range(j + 1):
                    state[j] += factor[kind, j, k] * normal[t, i, k]
                noise[t, j, i] = state[j]
    return noise
