"""Measurement noise without a model of the motion.

Noise of joint j is a stationary Ornstein–Uhlenbeck process seen at the frames; a share w_j may be
white beside it. It has sd σ_j and correlation (1 − w_j) ρ_j^(Δt/median interval) across Δt, from
quiet windows (`measurement.reml`).
"""

from typing import NamedTuple

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from softfinger.measurement.decisions import DECISIONS
from softfinger.measurement.memory import Memory, list_memories
from softfinger.measurement.reml import (
    Windows,
    cut_windows,
    evaluate_reml,
    find_memory,
    fit_joint,
    whiten_windows,
)


class NoiseFit(NamedTuple):
    """Noise that `fit_noise` found, and each joint's windows.

    The windows are quiet.
    """

    noise: xr.Dataset
    windows: list[Windows]

    @property
    def memories(self) -> list[Memory]:
        """How long each joint's noise lasts."""
        return list_memories(self.noise)


def fit_noise(angles: xr.Dataset, frames: xr.Dataset) -> NoiseFit:
    """Estimate each joint's noise without a motion model.

    Parameters
    ----------
    angles
        The `angles` artifact. If its attribute noise_sd_rad is finite, the sd is that number
        and only the autocorrelation is estimated.
    frames
        What `select_frames` gives.

    Returns
    -------
    NoiseFit
        noise: noise_sd (joint) [rad]; noise_autocorrelation (joint), per median frame interval;
        noise_white (joint), the share that is new in every frame; noise_correlation (joint,
        other_joint), of the innovations; window_count (joint); NaN for a joint without a window.
        windows: the quiet ones that show it.
    """
    declared = float(angles.attrs.get("noise_sd_rad", np.nan))
    windows = cut_windows(angles, frames)
    fits = _share_memory(
        [fit_joint(joint_windows, declared) for joint_windows in windows], declared
    )
    correlation = _correlate_joints([fit[2].rest for fit in fits], [fit[1] for fit in fits])
    coords = {"joint": angles["joint"].values, "other_joint": angles["joint"].values}
    noise = xr.Dataset(
        {
            "noise_sd": ("joint", np.array([fit[0] for fit in fits])),
            "noise_autocorrelation": ("joint", np.array([fit[1].autocorrelation for fit in fits])),
            "noise_white": ("joint", np.array([fit[1].white for fit in fits])),
            "noise_correlation": (("joint", "other_joint"), correlation),
            "window_count": ("joint", np.array([len(fit[2].rest.start) - 1 for fit in fits])),
        },
        coords=coords,
    )
    return NoiseFit(noise, [part.rest for part in windows])


def complete_noise(noise: xr.Dataset, angles: xr.Dataset, frames: xr.Dataset) -> xr.Dataset:
    """Fill the gaps of a noise estimate.

    An sd comes from second differences, else it is the other joints' sd.

    No sd is smaller than that of the angles' rounding: a step over √12.
    """
    sd = noise["noise_sd"].values.copy()
    angle = angles["joint_angle"].transpose("joint", "trial", "frame").values
    used = frames["used"].values
    for joint in np.flatnonzero(~(sd > 0)):
        bend = [np.diff(row[u], 2) for row, u in zip(angle[joint], used, strict=True)]
        bend = np.concatenate([part[np.isfinite(part)] for part in bend])
        sd[joint] = np.median(np.abs(bend)) / 0.6745 / np.sqrt(6.0) if bend.size else np.nan
    sd = np.fmax(sd, frames["rounding_sd"].values)
    moving = sd[sd > 1e-3 * np.nanmax(sd)] if np.isfinite(sd).any() else np.array([1e-6])
    sd = np.where(np.isin(sd, moving), sd, np.median(moving))
    rho = np.nan_to_num(noise["noise_autocorrelation"].values, nan=0.0)
    white = np.nan_to_num(noise["noise_white"].values, nan=0.0)
    correlation = np.nan_to_num(noise["noise_correlation"].values, nan=0.0)
    return noise.assign(
        noise_sd=("joint", sd),
        noise_autocorrelation=("joint", rho),
        noise_white=("joint", white),
        noise_correlation=(("joint", "other_joint"), correlation),
    )


def _share_memory(
    fits: list[tuple[float, Memory, Windows]], declared: float
) -> list[tuple[float, Memory, Windows]]:
    """Let joints share one memory.

    One camera gives one, unless the windows show otherwise.
    """
    known = [fit[2] for fit in fits if fit[2].dof > 0]
    if len(known) < 2:
        return fits

    memory = find_memory(known, declared)
    shared = [
        (evaluate_reml(fit[2].rest, memory, declared)[1], memory, fit[2]) if fit[2].dof > 0 else fit
        for fit in fits
    ]
    apart, together = (
        sum(evaluate_reml(fit[2], fit[1], declared)[0] for fit in some if fit[2].dof > 0)
        for some in (fits, shared)
    )
    return fits if together - apart > DECISIONS.own_rho * (len(known) - 1) else shared


def _correlate_joints(windows: list[Windows], memories: list[Memory]) -> NDArray:
    """Correlation of two joints' whitened residuals.

    It is over the calm frames that they share.
    """
    leftover = whiten_windows(windows, memories)
    correlation = np.eye(len(windows))
    for a in range(len(windows)):
        for b in range(a):
            _, i, j = np.intersect1d(windows[a].place, windows[b].place, return_indices=True)
            x, y = leftover[a][i], leftover[b][j]
            scale = np.sqrt((x @ x) * (y @ y))
            correlation[a, b] = correlation[b, a] = x @ y / scale if scale > 0 else np.nan
    return correlation
