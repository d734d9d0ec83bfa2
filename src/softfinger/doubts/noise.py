"""Noise and resolution of recorded angles."""

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
ROUNDING = 1e-9  # of the arithmetic, far below any noise [rad]
PIECE, MOST_PIECES = 4096, 100  # frames in a row, of which so many pieces show the noise
# Numbers that are rounded to steps show no noise below that of rounding.
OF_A_STEP = 1.0 / np.sqrt(12.0)
FINEST = 0.05  # quantile of the gaps between neighbouring values
DIFFERENT = 0.9  # share of values
MOST_VALUES = 20_000  # of which the gaps are looked at


def measure_noise(angle: Array) -> tuple[Array, Array]:
    """Noise sd (joint,) [rad] and correlation (joint, joint).

    Both come from second differences.

    Robust against the motion: of the frames, the half in which the joints bend least counts.
    """
    pieces = [_bend(angle[:, k : k + PIECE]) for k in _spread_pieces(angle.shape[1])]
    bend = np.concatenate(pieces, axis=1)
    joints = len(angle)
    if bend.shape[1] < 8:
        return np.full(joints, np.nan), np.full((joints, joints), np.nan)
    scale = 1.4826 * np.median(np.abs(bend), axis=1)
    scale = np.where(scale < ROUNDING, 0.0, scale)  # of rounded angles, mostly on a line
    size = np.abs(bend / np.where(scale > 0, scale, np.inf)[:, None]).max(axis=0)
    calm = bend[:, size < 4.0]
    if calm.shape[1] < 8:
        return scale / np.sqrt(6.0), np.full((joints, joints), np.nan)
    sd = calm.std(axis=1)
    covariance = np.cov(calm).reshape(joints, joints)
    product = np.outer(sd, sd)
    correlation = np.where(product > 0, covariance / np.where(product > 0, product, 1.0), np.nan)
    return scale / np.sqrt(6.0), correlation


def _spread_pieces(frames: int) -> list[int]:
    """First frames of pieces: all of a recording, or many evenly spread over a long one."""
    count = -(-frames // PIECE)
    if count <= MOST_PIECES:
        return [k * (PIECE - 2) for k in range(-(-frames // (PIECE - 2)))]
    return np.linspace(0, frames - PIECE, MOST_PIECES).astype(int).tolist()


def _bend(angle: Array) -> Array:
    """Second differences of frames in a row that are all seen."""
    bend = angle[:, 2:] - 2.0 * angle[:, 1:-1] + angle[:, :-2]
    return bend[:, np.isfinite(bend).all(axis=0)]


def measure_resolution(angle: Array) -> Array:
    """The step (joint,) [rad] to which angles are rounded.

    Rounded angles have equal values; where few are equal it is the smallest gap between two, which
    is next to nothing.

    >>> measure_resolution(np.array([[0.1, 0.3, 0.2, 0.2, 0.1]])).round(6)
    array([0.1])
    """
    steps = np.zeros(len(angle))
    for joint, values in enumerate(angle):
        seen = values[np.isfinite(values)][:MOST_VALUES]
        gaps = np.diff(np.unique(np.round(seen, 9)))
        if gaps.size:
            rounded = gaps.size < DIFFERENT * seen.size
            steps[joint] = np.quantile(gaps, FINEST if rounded else 0.0)
    return steps


def bound_noise(noise: Array, resolution: Array) -> Array:
    """Noise that is at least that of rounding (joint,)."""
    return np.maximum(noise, OF_A_STEP * resolution)
