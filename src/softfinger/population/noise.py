"""Measurement noise without a model of the motion.

Noise of joint j is a stationary Ornstein–Uhlenbeck process seen at the frames: sd σ_j and
correlation ρ_j^(Δt/median interval) across Δt, from quiet windows (`population.reml`).
"""

import numpy as np
import xarray as xr
from numpy.typing import NDArray
from scipy.special import expit
from scipy.stats import chi2

from softfinger.population.frames import select_frames
from softfinger.population.reml import (
    LEAST_SD,
    Windows,
    cut_windows,
    evaluate_reml,
    find_autocorrelation,
    fit_joint,
    minimise_deviance,
    profile_windows,
    whiten_array,
)

DIFFERENT = 9.0  # of −2 log L for each further ρ (3 sd) from which joints do not share one


def estimate_noise(angles: xr.Dataset, frames: xr.Dataset | None = None) -> xr.Dataset:
    """Estimate the noise of each joint angle without a model of the motion.

    Parameters
    ----------
    angles
        The `angles` artifact. If its attribute noise_sd_rad is finite, the sd is that number
        and only the autocorrelation is estimated.
    frames
        What `select_frames` says; computed when absent.

    Returns
    -------
    Dataset
        noise_sd (joint) [rad]; noise_autocorrelation (joint), per median frame interval;
        noise_correlation (joint, other_joint), of the innovations; window_count (joint).
        NaN for a joint without a window.
    """
    frames = select_frames(angles) if frames is None else frames
    joints = angles.sizes["joint"]
    declared = float(angles.attrs.get("noise_sd_rad", np.nan))
    windows = [cut_windows(angles, frames, joint) for joint in range(joints)]
    fits = _share_autocorrelation(
        [fit_joint(joint_windows, declared) for joint_windows in windows], declared
    )
    correlation = _correlate_joints([fit[2] for fit in fits], [fit[1] for fit in fits])
    coords = {"joint": angles["joint"].values, "other_joint": angles["joint"].values}
    return xr.Dataset(
        {
            "noise_sd": ("joint", np.array([fit[0] for fit in fits])),
            "noise_autocorrelation": ("joint", np.array([fit[1] for fit in fits])),
            "noise_correlation": (("joint", "other_joint"), correlation),
            "window_count": ("joint", np.array([len(fit[2].start) - 1 for fit in fits])),
        },
        coords=coords,
    )


def estimate_residual_noise(
    residual: NDArray[np.float64], time: NDArray[np.float64], interval: float
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Estimate sd and autocorrelation (joint,) of what a model leaves, as if all of it were noise.

    Parameters
    ----------
    residual
        (trial, joint, frame) [rad], NaN where not used.
    time
        (trial, frame) [s].
    interval
        Median frame interval [s].
    """
    sd, rho = np.full(residual.shape[1], np.nan), np.zeros(residual.shape[1])
    for j in range(residual.shape[1]):
        series = []
        for row, moment in zip(residual[:, j], time, strict=True):
            used = np.isfinite(row)
            if used.any():
                gap = np.diff(moment[used], prepend=-np.inf) / interval
                series.append((row[used, None], gap))
        count = sum(len(row) for row, _ in series)
        if not count:
            continue

        def evaluate(logit: float, series: list = series, count: int = count) -> tuple:
            parts = [whiten_array(row, gap, expit(logit)) for row, gap in series]
            square = sum(float((white**2).sum()) for white, _ in parts)
            variance = max(square / count, LEAST_SD**2)
            return count * np.log(variance) + sum(logdet for _, logdet in parts), variance

        best = minimise_deviance(lambda logit, evaluate=evaluate: evaluate(logit)[0])
        sd[j], rho[j] = np.sqrt(evaluate(best)[1]), expit(best)
    return sd, rho


def compare_noise(
    angles: xr.Dataset, sd: NDArray[np.float64], autocorrelation: NDArray[np.float64]
) -> float:
    """Test whether quiet windows allow a noise (joint,): p-value of the likelihood ratio."""
    frames = select_frames(angles)
    excess, numbers = 0.0, 0
    for joint in range(angles.sizes["joint"]):
        _, rho, windows = fit_joint(cut_windows(angles, frames, joint), np.nan)
        if windows.dof > 0 and np.isfinite(sd[joint]):
            free = evaluate_reml(windows, rho, np.nan)[0]
            given = evaluate_reml(windows, float(autocorrelation[joint]), float(sd[joint]))[0]
            excess += max(given - free, 0.0)
            numbers += 2
    return float(chi2.sf(excess, numbers)) if numbers else 1.0


def _share_autocorrelation(
    fits: list[tuple[float, float, Windows]], declared: float
) -> list[tuple[float, float, Windows]]:
    """Let joints share one ρ, as what one camera sees would, unless the windows say otherwise."""
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
    return fits if together - apart > DIFFERENT * (len(known) - 1) else shared


def _correlate_joints(windows: list[Windows], autocorrelation: list[float]) -> NDArray:
    """Correlation of the whitened leftovers of two joints over the calm frames that they share."""
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
