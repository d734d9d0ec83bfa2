"""Recordings as the diagnosis sees them: binned, with the whitening of their noise.

All arrays are padded to the longest trial, so that one compiled loop goes through a campaign.
"""

from typing import NamedTuple

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from softfinger.mismatch.binning import (
    Whitening,
    build_whitening,
    compute_bin_covariance_array,
    cut_bins_array,
    place_nodes_array,
)
from softfinger.population.covariance import compute_innovation_covariance_array
from softfinger.population.frames import select_frames
from softfinger.population.noise import estimate_noise
from softfinger.population.quiet import find_load_changes_array


class Trials(NamedTuple):
    """Binned trials.

    Attributes
    ----------
    name
        (trial,) names.
    interval
        Median frame interval [s].
    node
        (trial, bin, 2) [s], the two times whose mean stands for a bin; ends repeat the last.
    bins
        (trial,) how many bins are real.
    angle
        (trial, bin, joint) [rad], means of the bins.
    present
        (trial, joint) joints that were seen.
    load_time, load_torque
        (trial, knot) [s], [N m].
    changes
        One array (c,) [s] for each trial: when its load changes.
    starts, used
        One array each for each trial: first frame (among the used ones) of each bin; used frames.
    protocol
        (trial,) index into the whitening.
    band, first, size
        (protocol, row, width), (protocol, row), (protocol,): rows of W from column `first` on;
        a row is one present joint of one bin, joints fastest.
    logdet
        (protocol,) log|Σ|.
    """

    name: list[str]
    interval: float
    node: NDArray[np.float64]
    bins: NDArray[np.int64]
    angle: NDArray[np.float64]
    present: NDArray[np.bool_]
    load_time: NDArray[np.float64]
    load_torque: NDArray[np.float64]
    changes: list[NDArray[np.float64]]
    starts: list[NDArray[np.int64]]
    used: list[NDArray[np.int64]]
    protocol: NDArray[np.int64]
    band: NDArray[np.float64]
    first: NDArray[np.int64]
    size: NDArray[np.int64]
    logdet: NDArray[np.float64]

    @property
    def rows(self) -> int:
        """The number of binned angles of the campaign."""
        return int(self.size[self.protocol].sum())

    @property
    def joints(self) -> int:
        """The number of joints."""
        return self.present.shape[1]


def prepare_trials(
    angles: xr.Dataset, noise: xr.Dataset | None = None
) -> tuple[Trials, xr.Dataset]:
    """Bin every usable trial of a campaign and whiten its noise.

    Parameters
    ----------
    angles
        The `angles` artifact.
    noise
        Known noise; estimated when absent.

    Returns
    -------
    trials, noise
        `noise` as from `estimate_noise`, complete: a joint without a quiet window takes its sd from
        second differences and counts as white.
    """
    frames = select_frames(angles)
    if noise is None:
        noise = complete_noise(estimate_noise(angles, frames), angles, frames)
    time = angles["time"].transpose("trial", "frame").values
    angle = angles["joint_angle"].transpose("trial", "joint", "frame").values
    interval = float(frames["frame_interval"])
    keep = np.flatnonzero(frames["used"].values.any(axis=1))
    load = [angles[name].transpose("trial", "knot").values for name in ("load_time", "load_torque")]
    parts, kinds, changes, starts, used = [], {}, [], [], []
    for i in keep:
        frame = np.flatnonzero(frames["used"].values[i])
        moment, scale = time[i, frame], frames["frame_scale"].values[i, frame]
        present = frames["present"].values[i]
        changes.append(find_load_changes_array(load[0][i], load[1][i]))
        cut = cut_bins_array(moment, changes[-1], interval)
        key = (moment.tobytes(), scale.tobytes(), present.tobytes(), cut.tobytes())
        if key not in kinds:
            kinds[key] = (len(kinds), _whiten_trial(moment / interval, scale, cut, present, noise))
        mean = np.add.reduceat(angle[i][:, frame], cut[:-1], axis=1) / np.diff(cut)
        parts.append((place_nodes_array(moment, cut), mean.T, present, kinds[key][0]))
        starts.append(cut)
        used.append(frame)
    band, first, size, logdet = _stack_whitening([kind[1] for kind in kinds.values()])
    bins = np.array([len(part[1]) for part in parts])
    trials = Trials(
        [str(angles["trial"].values[i]) for i in keep],
        interval,
        np.maximum.accumulate(
            _pad([part[0] for part in parts], bins.max()).reshape(len(parts), -1), axis=1
        ).reshape(len(parts), -1, 2),
        bins,
        _pad([part[1] for part in parts], bins.max()),
        np.stack([part[2] for part in parts]),
        load[0][keep],
        load[1][keep],
        changes,
        starts,
        used,
        np.array([part[3] for part in parts]),
        band,
        first,
        size,
        logdet,
    )
    return trials, noise


def complete_noise(noise: xr.Dataset, angles: xr.Dataset, frames: xr.Dataset) -> xr.Dataset:
    """Fill the gaps of a noise estimate: sd from second differences, else the other joints' sd."""
    sd = noise["noise_sd"].values.copy()
    angle = angles["joint_angle"].transpose("joint", "trial", "frame").values
    used = frames["used"].values
    for joint in np.flatnonzero(~(sd > 0)):
        bend = [np.diff(row[u], 2) for row, u in zip(angle[joint], used, strict=True)]
        bend = np.concatenate([part[np.isfinite(part)] for part in bend])
        sd[joint] = np.median(np.abs(bend)) / 0.6745 / np.sqrt(6.0) if bend.size else np.nan
    moving = sd[sd > 1e-3 * np.nanmax(sd)] if np.isfinite(sd).any() else np.array([1e-6])
    sd = np.where(np.isin(sd, moving), sd, np.median(moving))
    rho = np.nan_to_num(noise["noise_autocorrelation"].values, nan=0.0)
    correlation = np.nan_to_num(noise["noise_correlation"].values, nan=0.0)
    return noise.assign(
        noise_sd=("joint", sd),
        noise_autocorrelation=("joint", rho),
        noise_correlation=(("joint", "other_joint"), correlation),
    )


def _whiten_trial(
    time: NDArray, scale: NDArray, starts: NDArray, present: NDArray, noise: xr.Dataset
) -> Whitening:
    sd, rho = noise["noise_sd"].values, noise["noise_autocorrelation"].values
    correlation = noise["noise_correlation"].values
    stationary = compute_innovation_covariance_array(np.inf, sd, rho, correlation)
    seen = np.ix_(present, present)
    covariance = compute_bin_covariance_array(time, scale, starts, stationary[seen], rho[present])
    return build_whitening(covariance)


def _stack_whitening(kinds: list[Whitening]) -> tuple[NDArray, NDArray, NDArray, NDArray]:
    """Keep of each row of W only what matters: band[row, c] = W[row, first + c]."""
    size = np.array([len(kind.matrix) for kind in kinds])
    width = max(int((np.arange(len(k.first)) - k.first).max()) + 1 for k in kinds)
    band = np.zeros((len(kinds), size.max(), width))
    first = np.zeros((len(kinds), size.max()), np.int64)
    for kind, (whitening, m) in enumerate(zip(kinds, size, strict=True)):
        first[kind, :m] = whitening.first
        for row in range(m):
            begin = whitening.first[row]
            band[kind, row, : row + 1 - begin] = whitening.matrix[row, begin : row + 1]
    return band, first, size, np.array([kind.logdet for kind in kinds])


def _pad(parts: list[NDArray], length: int) -> NDArray:
    """Stack arrays (n, …) of different length, the last row repeated."""
    return np.stack([part[np.minimum(np.arange(length), len(part) - 1)] for part in parts])
