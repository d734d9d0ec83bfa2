"""Time bins that widen after each change of load.

The covariance of their noise is exact.

A bin's angle is the mean of its frames. A model's bin mean is the mean of the model at the bin's
mean time ± the sd of its frame times: exact for a quadratic, and for a cubic where the bin is
symmetric. Noise is Ornstein–Uhlenbeck at the frames, so between bins a before b the covariance of
joints j, k splits into a tail, a gap and a head:

    cov(ε̄_aj, ε̄_bk) = Σ_jk · mean_a(s ρ_k^(end_a − t)) · ρ_k^gap · mean_b(s ρ_k^(t − begin_b))

A share w of the noise may be white beside it: Σ_jk √((1 − w_j)(1 − w_k)) lasts, and the mean of n
frames has Σ_jk √(w_j w_k) mean(s²)/n more.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import solve_triangular

from softfinger.compiled import compiled
from softfinger.measurement.budget import BUDGET

NEGLIGIBLE = 1e-9  # of a row of the whitening matrix


class Whitening(NamedTuple):
    """Rows of W with WᵀW = Σ⁻¹.

    W is lower triangular; row i begins in column `first[i]`.
    """

    matrix: NDArray[np.float64]
    first: NDArray[np.int64]
    logdet: float  # log|Σ|


def cut_bins_array(
    time: NDArray[np.float64], changes: NDArray[np.float64], interval: float
) -> NDArray[np.int64]:
    """Cut the times (n,) of a trial into bins.

    Returns the first frame of each bin, and n.

    Parameters
    ----------
    time
        (n,) [s], increasing.
    changes
        (c,) [s], times at which the load changes.
    interval
        Median frame interval [s].

    Examples
    --------
    >>> cut_bins_array(np.arange(0.0, 5.0, 0.05), np.zeros(1), 0.05)[[0, 1, 2, -2, -1]]
    array([  0,   1,   2,  99, 100])
    """
    edges = np.concatenate([[time[0]], changes[changes > time[0]]])
    since = time - edges[np.searchsorted(edges, time, side="right") - 1]
    widest = np.minimum(BUDGET.bin_growth * since, BUDGET.bin_share * (time[-1] - time[0]))
    phase = np.searchsorted(edges, time, side="right")
    return _cut(time, widest, phase, BUDGET.bin_gap * interval)


@compiled
def _cut(time: NDArray, widest: NDArray, phase: NDArray, longest_gap: float) -> NDArray:
    starts = [0]
    for i in range(1, time.size):
        begin = starts[-1]
        wide = time[i] - time[begin] > widest[begin]
        if wide or phase[i] != phase[begin] or time[i] - time[i - 1] > longest_gap:
            starts.append(i)
    starts.append(time.size)
    return np.array(starts)


def place_nodes_array(time: NDArray[np.float64], starts: NDArray[np.int64]) -> NDArray[np.float64]:
    """Place two times in each bin: (bin, 2) [s].

    Their mean and sd are those of the bin's frames.

    >>> place_nodes_array(np.array([0.0, 1.0, 3.0]), np.array([0, 1, 3]))
    array([[0., 0.],
           [1., 3.]])
    """
    count = np.diff(starts)
    mean = np.add.reduceat(time, starts[:-1]) / count
    offset = time - np.repeat(mean, count)
    sd = np.sqrt(np.add.reduceat(offset**2, starts[:-1]) / count)
    return np.stack([mean - sd, mean + sd], axis=1)


def compute_bin_covariance_array(
    time: NDArray[np.float64],
    scale: NDArray[np.float64],
    starts: NDArray[np.int64],
    stationary: NDArray[np.float64],
    autocorrelation: NDArray[np.float64],
    white: NDArray[np.float64],
) -> NDArray[np.float64]:
    """Compute the covariance of bin means, joints fastest.

    It is (bin · joint, bin · joint) [rad²].

    Parameters
    ----------
    time
        (n,) times of the frames, in median frame intervals.
    scale
        (n,) factor on the noise of each frame.
    starts
        (bin + 1,) first frame of each bin, and n.
    stationary
        (joint, joint) [rad²], covariance of the joints' noise at one frame of scale 1.
    autocorrelation
        (joint,) ρ in [0, 1), over one median interval.
    white
        (joint,) share of the noise that is new in every frame.
    """
    bins, joints = starts.size - 1, len(autocorrelation)
    rate = -np.log(np.maximum(autocorrelation, 1e-300))
    lasting, fresh = np.sqrt(1.0 - white), np.sqrt(white)
    covariance = _fill_covariance(
        time, scale, starts, stationary * np.outer(lasting, lasting), rate
    )
    mean_square = np.add.reduceat(scale**2, starts[:-1]) / np.diff(starts) ** 2
    place = np.arange(bins)
    covariance[place, :, place] += np.multiply.outer(
        mean_square, stationary * np.outer(fresh, fresh)
    )
    return covariance.reshape(bins * joints, bins * joints)


@compiled
def _fill_covariance(
    time: NDArray, scale: NDArray, starts: NDArray, stationary: NDArray, rate: NDArray
) -> NDArray:
    bins, joints = starts.size - 1, rate.size
    head, tail = np.zeros((bins, joints)), np.zeros((bins, joints))
    covariance = np.zeros((bins, joints, bins, joints))
    for b in range(bins):
        first, last = starts[b], starts[b + 1] - 1
        count = last - first + 1
        for k in range(joints):
            for i in range(first, last + 1):
                head[b, k] += scale[i] * np.exp(-rate[k] * (time[i] - time[first])) / count
                tail[b, k] += scale[i] * np.exp(-rate[k] * (time[last] - time[i])) / count
        within = _mean_pairs(time[first : last + 1], scale[first : last + 1], rate)
        for j in range(joints):
            for k in range(joints):
                covariance[b, j, b, k] = stationary[j, k] * (within[j] + within[k]) / 2
        for a in range(b):
            gap = time[first] - time[starts[a + 1] - 1]
            for j in range(joints):
                for k in range(joints):
                    value = stationary[j, k] * tail[a, k] * np.exp(-rate[k] * gap) * head[b, k]
                    covariance[a, j, b, k] = value
                    covariance[b, k, a, j] = value
    return covariance


@compiled
def _mean_pairs(time: NDArray, scale: NDArray, rate: NDArray) -> NDArray:
    """Mean covariance of all pairs of frames, by rate.

    Mean of s_a s_b exp(−rate |t_a − t_b|).
    """
    total = np.zeros(rate.size)
    for k in range(rate.size):
        carried = 0.0
        for i in range(time.size):
            if i > 0:
                decay = np.exp(-rate[k] * (time[i] - time[i - 1]))
                carried = (carried + scale[i - 1]) * decay
            total[k] += scale[i] * (scale[i] + 2.0 * carried)
    return total / time.size**2


def build_whitening(covariance: NDArray[np.float64]) -> Whitening:
    """Build W = L⁻¹ of Σ = L Lᵀ.

    Entries of a row that do not matter are left out.

    >>> build_whitening(np.array([[4.0, 0.0], [0.0, 9.0]])).matrix.round(6)
    array([[0.5     , 0.      ],
           [0.      , 0.333333]])
    """
    factor = np.linalg.cholesky(covariance)
    matrix = solve_triangular(factor, np.eye(len(factor)), lower=True, check_finite=False)
    matter = np.abs(matrix) > NEGLIGIBLE * np.abs(np.diag(matrix))[:, None]
    first = matter.argmax(axis=1)
    logdet = 2.0 * float(np.log(np.diag(factor)).sum())
    return Whitening(np.tril(matrix), first, logdet)
