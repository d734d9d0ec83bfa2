"""Recordings as the diagnosis uses them.

They are binned, with the whitening of their noise.

All arrays are padded to the longest trial, so that one compiled loop goes through a campaign.
"""

from typing import NamedTuple

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from softfinger.measurement.binning import (
    Whitening,
    build_whitening,
    compute_bin_covariance_array,
    cut_bins_array,
    place_nodes_array,
)
from softfinger.measurement.covariance import compute_innovation_covariance_array
from softfinger.measurement.quiet import find_load_changes_array


class Trials(NamedTuple):
    """Binned trials.

    Attributes
    ----------
    name
        (trial,) names.
    interval
        Median frame interval [s].
    node
        (trial, bin, 2) [s], the two times whose mean represents a bin; ends repeat the last.
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
    scale
        (trial, bin, joint) factor on the noise; a row is divided by it before it is whitened.
    protocol
        (trial,) index into the whitening.
    band, first, size
        (protocol, row, width), (protocol, row), (protocol,): rows of W from column `first` on;
        a row is one present joint of one bin, joints fastest.
    logdet
        (trial,) log|Σ|.
    trust
        (trial, row) factor on a white row, at most 1: less where heavy tails explain it.
    tails
        (trial,) what they add to the log evidence [nats].
    soft
        (trial, row, k) D of directions in which the noise is larger: white rows x, with Σ white,
        become x − D Dᵀ x.
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
    scale: NDArray[np.float64]
    protocol: NDArray[np.int64]
    band: NDArray[np.float64]
    first: NDArray[np.int64]
    size: NDArray[np.int64]
    logdet: NDArray[np.float64]
    trust: NDArray[np.float64]
    tails: NDArray[np.float64]
    soft: NDArray[np.float64]

    @property
    def rows(self) -> int:
        """Number of binned angles of the campaign."""
        return int(self.size[self.protocol].sum())

    @property
    def joints(self) -> int:
        """Number of joints."""
        return self.present.shape[1]


def prepare_trials(angles: xr.Dataset, measurement: xr.Dataset) -> Trials:
    """Bin every usable trial, and whiten its noise.

    Parameters
    ----------
    angles
        The `angles` artifact.
    measurement
        Its frames and noise, as `measurement.measure` describes them.
    """
    time = angles["time"].transpose("trial", "frame").values
    angle = angles["joint_angle"].transpose("trial", "joint", "frame").values
    interval = float(measurement["frame_interval"])
    every, claimed = measurement["used"].values, measurement["frame_scale"].values
    factor = measurement["noise_factor"].transpose("trial", "joint", "frame").values
    keep = np.flatnonzero(every.any(axis=1))
    load = [angles[name].transpose("trial", "knot").values for name in ("load_time", "load_torque")]
    parts, kinds, changes, starts, used = [], {}, [], [], []
    for i in keep:
        frame = np.flatnonzero(every[i])
        moment, claim = time[i, frame], claimed[i, frame]
        present = measurement["present"].values[i]
        changes.append(find_load_changes_array(load[0][i], load[1][i]))
        cut = cut_bins_array(moment, changes[-1], interval)
        key = (moment.tobytes(), claim.tobytes(), present.tobytes(), cut.tobytes())
        if key not in kinds:
            whitening = _whiten_trial(moment / interval, claim, cut, present, measurement)
            kinds[key] = (len(kinds), whitening)
        mean = _average_bins(angle[i][:, frame], cut)
        scale = np.sqrt(_average_bins(factor[i][:, frame] ** 2, cut))
        parts.append((place_nodes_array(moment, cut), mean, present, *kinds[key], scale))
        starts.append(cut)
        used.append(frame)
    names = [str(angles["trial"].values[i]) for i in keep]
    kept = (names, interval), (load[0][keep], load[1][keep], changes, starts, used)
    return _stack_trials(*kept, parts, [whitening for _, whitening in kinds.values()])


def _stack_trials(head: tuple, middle: tuple, parts: list[tuple], kinds: list[Whitening]) -> Trials:
    """Stack what `parts` has of every trial.

    That is nodes, means, present joints, kind, whitening and scales of its bins.

    `head` and `middle` are the fields before and between those.
    """
    nodes, means, present, kind, whitening, scales = zip(*parts, strict=True)
    bins = np.array([len(mean) for mean in means])
    node = _pad(list(nodes), bins.max()).reshape(len(parts), -1)
    band, first, size = _stack_whitening(kinds)
    volumes = [
        w.logdet + 2 * np.log(scale[:, there]).sum()
        for w, scale, there in zip(whitening, scales, present, strict=True)
    ]
    return Trials(
        *head,
        np.maximum.accumulate(node, axis=1).reshape(len(parts), -1, 2),
        bins,
        _pad(list(means), bins.max()),
        np.stack(present),
        *middle,
        _pad(list(scales), bins.max()),
        np.array(kind),
        band,
        first,
        size,
        np.array(volumes),
        np.ones((len(parts), size.max())),
        np.zeros(len(parts)),
        np.zeros((len(parts), size.max(), 0)),
    )


def _average_bins(values: NDArray, starts: NDArray) -> NDArray:
    """Means (bin, joint) of values (joint, frame)."""
    return (np.add.reduceat(values, starts[:-1], axis=1) / np.diff(starts)).T


def _whiten_trial(
    time: NDArray, scale: NDArray, starts: NDArray, present: NDArray, noise: xr.Dataset
) -> Whitening:
    sd, rho = noise["noise_sd"].values, noise["noise_autocorrelation"].values
    correlation, white = noise["noise_correlation"].values, noise["noise_white"].values
    stationary = compute_innovation_covariance_array(np.inf, sd, rho, correlation)
    seen = np.ix_(present, present)
    covariance = compute_bin_covariance_array(
        time, scale, starts, stationary[seen], rho[present], white[present]
    )
    return build_whitening(covariance)


def _stack_whitening(kinds: list[Whitening]) -> tuple[NDArray, NDArray, NDArray]:
    """Keep of each row of W only what matters.

    band[row, c] = W[row, first + c].
    """
    size = np.array([len(kind.matrix) for kind in kinds])
    width = max(int((np.arange(len(k.first)) - k.first).max()) + 1 for k in kinds)
    band = np.zeros((len(kinds), size.max(), width))
    first = np.zeros((len(kinds), size.max()), np.int64)
    for kind, (whitening, m) in enumerate(zip(kinds, size, strict=True)):
        first[kind, :m] = whitening.first
        for row in range(m):
            begin = whitening.first[row]
            band[kind, row, : row + 1 - begin] = whitening.matrix[row, begin : row + 1]
    return band, first, size


def _pad(parts: list[NDArray], length: int) -> NDArray:
    """Stack arrays (n, …), the last row repeated."""
    return np.stack([part[np.minimum(np.arange(length), len(part) - 1)] for part in parts])
