"""Measurement noise without a model of the motion.

Noise of joint j is a stationary Ornstein–Uhlenbeck process seen at the frames: sd σ_j and
correlation ρ_j^(Δt/median interval) across Δt, from quiet windows (`measurement.reml`).
"""

from typing import NamedTuple

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from softfinger.measurement.decisions import DECISIONS
from softfinger.measurement.reml import (
    Windows,
    cut_windows,
    evaluate_reml,
    find_autocorrelation,
    fit_joint,
    profile_windows,
)


class NoiseFit(NamedTuple):
    """Noise that `fit_noise` found, and each joint's windows.

    The windows are quiet.
    """

    noise: xr.Dataset
    windows: list[Windows]

    @property
    def autocorrelation(self) -> NDArray[np.float64]:
        """ρ of each joint (joint,)."""
        return self.noise["noise_autocorrelation"].values


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
        noise_correlation (joint, other_joint), of the innovations; window_count (joint); NaN for a
        joint without a window. windows: the quiet ones that show it.
    """
    declared = float(angles.attrs.get("noise_sd_rad", np.nan))
    windows = [cut_windows(angles, frames, joint) for joint in range(angles.sizes["joint"])]
    fits = _share_autocorrelation(
        [fit_joint(joint_windows, declared) for joint_windows in windows], declared
    )
    correlation = _correlate_joints([fit[2] for fit in fits], [fit[1] for fit in fits])
    coords = {"joint": angles["joint"].values, "other_joint": angles["joint"].values}
    noise = xr.Dataset(
        {
            "noise_sd": ("joint", np.array([fit[0] for fit in fits])),
            "noise_autocorrelation": ("joint", np.array([fit[1] for fit in fits])),
            "noise_correlation": (("joint", "other_joint"), correlation),
            "window_count": ("joint", np.array([len(fit[2].start) - 1 for fit in fits])),
        },
        coords=coords,
    )
    return NoiseFit(noise, windows)


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
    correlation = np.nan_to_num(noise["noise_correlation"].values, nan=0.0)
    return noise.assign(
        noise_sd=("joint", sd),
        noise_autocorrelation=("joint", rho),
        noise_correlation=(("joint", "other_joint"), correlation),
    )


def _share_autocorrelation(
    fits: list[tuple[float, float, Windows]], declared: float
) -> list[tuple[float, float, Windows]]:
    """Let joints share one ρ.

    One camera gives one ρ, unless the windows show otherwise.
    """
    known = [fit[2] for fit in fits if fit[2].dof > 0]
    if len(known) < 2:
        return fits

    rho = find_autocorrelation(known, declared)
    shared = [
        (evaluate_reml(fit[2], rho, declared)[1], rho, fit[2]) if fit[2].dof > 0 else fit
        for fit in fits
    ]
    apart, together = (
        sum(evaluate_reml(fit[2], fit[1], declared)[0] for fit in some if fit[2].dof > 0)
        for some in (fits, shared)
    )
    return fits if together - apart > DECISIONS.own_rho * (len(known) - 1) else shared


def _correlate_joints(windows: list[Windows], autocorrelation: list[float]) -> NDArray:
    """Correlation of two joints' whitened residuals.

    It is over the calm frames that they share.
    """
    leftover = []
    for part, rho in zip(windows, autocorrelation, strict=True):
        residual = np.empty(len(part.rows))
        if np.isfinite(rho):
            profile_windows(rho, *part[:3], residual)
        leftover.append(residual)
    correlation = np.eye(len(windows))
    for a in range(len(windows)):
        for b in range(a):
            _, i, j = np.intersect1d(windows[a].place, windows[b].place, return_indices=True)
            x, y = leftover[a][i], leftover[b][j]
            scale = np.sqrt((x @ x) * (y @ y))
            correlation[a, b] = correlation[b, a] = x @ y / scale if scale > 0 else np.nan
    return correlation
