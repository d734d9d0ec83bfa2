"""What the fit leaves after changes of load."""

from __future__ import annotations

import numpy as np
import xarray as xr
from numpy.typing import NDArray
from scipy.signal import find_peaks, periodogram

CHANGES = ("rise", "fall")
SMALLEST_CHANGE = 0.05
"""Least change of load, over the load's range."""
RING_PROMINENCE = 0.5
"""Least prominence of a ring, over its height."""
RING_CHANCE = 1e-4
"""Largest chance of a ring without a shared phase."""


def summarise_residuals(
    angles: xr.Dataset, posterior: xr.Dataset, fitted: xr.DataArray
) -> xr.Dataset:
    """Summarise what the fit leaves, beside claimed noise.

    Parameters
    ----------
    posterior
        noise_sd (chain, draw, joint) [rad].
    fitted
        (trial, joint, frame) [rad], of `compute_fitted_angle`.

    Returns
    -------
    Dataset
        What `compute_residuals` returns, with residual_rms, noise_mean, noise_sd, largest_mean
        (joint) [rad], the declared noise [rad], largest_share () of the range of the recorded
        angles, and rings (ring) [Hz], each frequency once as it reads with one decimal.
    """
    chosen = angles.sel(trial=fitted["trial"])
    residual = (chosen["joint_angle"].transpose(*fitted.dims) - fitted).where(select_good(chosen))
    found = compute_residuals(chosen, residual)
    recorded = chosen["joint_angle"].where(select_good(chosen))
    largest = np.abs(found["mean_residual"]).max(("change", "since_change"))
    noise = posterior["noise_sd"]
    peaks = found["peak_frequency"].values
    return found.assign(
        residual_rms=np.sqrt((residual**2).mean(("trial", "frame"))),
        noise_mean=noise.mean(("chain", "draw")),
        noise_sd=noise.std(("chain", "draw")),
        noise_declared=((), float(angles.attrs.get("noise_sd_rad", np.nan))),
        largest_mean=largest,
        largest_share=largest.max() / (recorded.max() - recorded.min()),
        rings=("ring", np.unique(np.round(peaks[np.isfinite(peaks)], 1))),
    )


def select_good(angles: xr.Dataset) -> xr.DataArray:
    """Select the unflagged angles (trial, joint, frame)."""
    return angles["angle_flag"].transpose("trial", "joint", "frame") == 0


def compute_residuals(angles: xr.Dataset, residual: xr.DataArray) -> xr.Dataset:
    """Compute mean and spectrum of residuals.

    The time counts from the last change of load.

    Parameters
    ----------
    residual
        Recording minus model (trial, joint, frame) [rad], NaN on flagged frames.

    Returns
    -------
    Dataset
        n_segments (change);
        mean_residual, residual_se (change, joint, since_change) [rad], over the stretches after
        each change of load, NaN where fewer than two reach that time; of a single stretch the
        mean is its own, and its error NaN;
        residual_power (change, joint, frequency) [rad2], frequency times power spectral density,
        the mean over stretches; peak_frequency (change, joint) [Hz], NaN without a ring.
        Changes of load are jumps of at least 5 % of the load's range; a load without any counts
        from its first knot, as a rise.
    """
    interval = float(np.nanmedian(np.diff(angles["time"].values, axis=1)))
    found = {change: [] for change in CHANGES}
    for change, *segment in find_segments(angles):
        found[change].append(bin_segment(angles, residual, interval, *segment))
    changes = [change for change in CHANGES if found[change]]
    sizes = [segment.shape[1] for change in changes for segment in found[change]]
    length, window = max(sizes), int(np.median(sizes))
    summaries = [summarise_segments(found[change], length, window, interval) for change in changes]
    summary = xr.concat(summaries, xr.Variable("change", changes), join="exact")
    coords = {"joint": angles["joint"], "since_change": (np.arange(length) + 0.5) * interval}
    return summary.assign_coords(coords).reset_coords(drop=True)


def find_segments(angles: xr.Dataset) -> list[tuple[str, int, float, float]]:
    """Find stretches: (change, trial index, start, end [s])."""
    jumps = [list_load_jumps(*knots) for knots in _each_load(angles)]
    if not any(jumps):
        jumps = [[(float(time[0]), 1.0)] for time, _ in _each_load(angles)]
    segments = []
    for trial, found in enumerate(jumps):
        ends = [time for time, _ in found[1:]] + [np.inf]
        for (start, size), end in zip(found, ends, strict=True):
            segments.append(("rise" if size > 0 else "fall", trial, start, end))
    return segments


def _each_load(angles: xr.Dataset) -> zip[tuple[NDArray, NDArray]]:
    return zip(angles["load_time"].values, angles["load_torque"].values, strict=True)


def list_load_jumps(load_time: NDArray, load_torque: NDArray) -> list[tuple[float, float]]:
    """Find the jumps (time, size) of a load.

    The load is (knot,); the jump from rest at the first knot counts too.

    >>> list_load_jumps(np.array([1.0, 3.0, 3.0, 4.0]), np.array([0.2, 0.2, 0.0, 0.0]))
    [(1.0, 0.2), (3.0, -0.2)]
    """
    time = np.concatenate([load_time[:1], load_time])
    load = np.concatenate([[0.0], load_torque])
    step = np.diff(load)
    jumped = (np.diff(time) == 0) & (np.abs(step) >= SMALLEST_CHANGE * np.ptp(load)) & (step != 0)
    return [(float(time[i]), float(step[i])) for i in np.flatnonzero(jumped)]


def bin_segment(
    angles: xr.Dataset,
    residual: xr.DataArray,
    interval: float,
    trial: int,
    start: float,
    end: float,
) -> NDArray[np.float64]:
    """Average a stretch: (joint, bin) [rad], each `interval` [s]."""
    time = angles["time"].values[trial]
    inside = (time >= start) & (time < end)
    # frames at whole multiples must not fall either way by rounding
    place = np.floor((time[inside] - start) / interval + 1e-6).astype(int)
    values = residual.values[trial][:, inside]
    bins = int(place.max(initial=0)) + 1
    binned = np.full((values.shape[0], bins), np.nan)
    for joint, row in enumerate(values):
        seen = np.isfinite(row)
        count = np.bincount(place[seen], minlength=bins)
        total = np.bincount(place[seen], weights=row[seen], minlength=bins)
        binned[joint] = np.divide(total, count, out=np.full(bins, np.nan), where=count > 0)
    return binned


def summarise_segments(
    segments: list[NDArray], length: int, window: int, interval: float
) -> xr.Dataset:
    """Summarise stretches (joint, bin) after changes alike."""
    padded = np.full((len(segments), segments[0].shape[0], length), np.nan)
    for row, segment in zip(padded, segments, strict=True):
        row[:, : segment.shape[1]] = segment
    count = np.isfinite(padded).sum(axis=0)
    enough = np.where(count >= min(2, len(segments)), count, np.nan)
    mean = np.nansum(padded, axis=0) / np.where(enough > 0, enough, np.nan)
    freedom = np.where(enough > 1, enough - 1, np.nan)
    spread = np.sqrt(np.nansum((padded - mean) ** 2, axis=0) / freedom)
    frequency, power, shared = compute_spectrum(segments, window, interval)
    ring = [find_ring(frequency, *pair, len(segments)) for pair in zip(power, shared, strict=True)]
    return xr.Dataset(
        {
            "n_segments": ((), len(segments)),
            "mean_residual": (("joint", "since_change"), mean),
            "residual_se": (("joint", "since_change"), spread / np.sqrt(enough)),
            "residual_power": (("joint", "frequency"), frequency * power),
            "peak_frequency": ("joint", np.array(ring)),
        },
        coords={"frequency": frequency},
    )


def compute_spectrum(
    segments: list[NDArray], length: int, interval: float
) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
    """Compute the stretches' power spectral density.

    The mean of all, and that of their mean.

    Stretches are cut to `length` bins, shorter ones ended with zeros, gaps bridged by straight
    lines, each freed of its straight trend and tapered (Hann).

    Returns
    -------
    frequency (frequency,) [Hz]; power, shared (joint, frequency) [rad2/Hz].
    """
    filled = np.zeros((len(segments), segments[0].shape[0], length))
    for row, segment in zip(filled, segments, strict=True):
        for target, values in zip(row, segment[:, :length], strict=True):
            seen = np.flatnonzero(np.isfinite(values))
            if seen.size:
                target[: values.size] = np.interp(np.arange(values.size), seen, values[seen])
    options = {"fs": 1 / interval, "window": "hann", "detrend": "linear", "nfft": 4 * length}
    frequency, power = periodogram(filled, **options)
    shared = periodogram(filled.mean(axis=0), **options)[1]
    kept = frequency >= 1 / (length * interval)
    return frequency[kept], power.mean(axis=0)[:, kept], shared[:, kept]


def find_ring(frequency: NDArray, power: NDArray, shared: NDArray, n_segments: int) -> float:
    """Find the strongest ring [Hz] that trials share.

    It is a narrow peak; NaN where there is none.

    For n normal trials that share no phase, shared / power exceeds R with probability
    (1 − R)^(n − 1); that is multiplied by the number of frequencies looked at. One trial shares
    nothing, so it has no ring.
    """
    weighted = frequency * power
    peaks, found = find_peaks(weighted, prominence=0)
    share = np.clip(shared[peaks] / power[peaks], 0, 1)
    chance = (1 - share) ** (n_segments - 1) * frequency.size
    stands_out = found["prominences"] >= RING_PROMINENCE * weighted[peaks]
    rings = peaks[stands_out & (chance < RING_CHANCE)]
    return float(frequency[rings[np.argmax(weighted[rings])]]) if rings.size else np.nan
