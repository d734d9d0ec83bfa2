"""Marker positions that cannot be true."""

from itertools import combinations

import numpy as np
import xarray as xr

from softfinger.measurement.flags import JUMP, MISSING
from softfinger.tracking.outliers import find_jumps_array

_STRETCH = 0.1  # of a distance that should be rigid
_ABOVE_NOISE = 8.0


def flag_markers(markers: xr.Dataset, load_jumps: np.ndarray) -> xr.Dataset:
    """Flag missing markers and impossible positions.

    A marker is suspect where it leaves its path at once and returns at once, and where its distance
    from another one on its rigid link differs from the usual by more than a tenth and by more
    than eight noise standard deviations (then both are).

    Parameters
    ----------
    markers : Dataset
        One trial: ``time``, ``marker_position (frame, marker, axis) [px]``, perhaps
        ``marker_flag``.
    load_jumps : (jump,) [s]
        Times at which a marker may well move at once.

    Returns
    -------
    Dataset
        With ``marker_flag (frame, marker)``; positions stay as they are.
    """
    position = markers["marker_position"].transpose("frame", "marker", "axis").to_numpy()
    time = markers["time"].to_numpy()
    flag = np.where(np.isfinite(position).all(axis=-1), 0, MISSING).astype(np.uint8)
    if "marker_flag" in markers:
        flag |= markers["marker_flag"].transpose("frame", "marker").to_numpy()
    for marker in range(position.shape[1]):
        flag[find_jumps_array(time, position[:, marker], load_jumps), marker] |= JUMP
    links = np.array([str(name).rsplit("_", 1)[0] for name in markers["marker"].to_numpy()])
    for a, b in combinations(range(links.size), 2):
        if links[a] == links[b]:
            stretched = find_stretched_array(position[:, a], position[:, b])
            flag[np.ix_(stretched, [a, b])] |= JUMP
    return markers.assign(marker_flag=(("frame", "marker"), flag))


def find_stretched_array(first: np.ndarray, second: np.ndarray) -> np.ndarray:
    """Frames with a wrong distance on a link.

    Two markers there are not as far apart as usual.

    Parameters
    ----------
    first, second : (frame, 2) [px]

    Returns
    -------
    (frame,) bool

    Examples
    --------
    >>> first, second = np.zeros((5, 2)), np.array([[9.0, 0], [9, 0], [0, 9], [20, 0], [9, 0]])
    >>> find_stretched_array(first, second)
    array([False, False, False,  True, False])
    """
    gap = np.hypot(*(second - first).T)
    seen = np.isfinite(gap)
    if not seen.any():
        return seen
    usual = np.median(gap[seen])
    noise = 1.4826 * np.median(np.abs(gap[seen] - usual))
    off = np.abs(np.where(seen, gap, usual) - usual)
    return off > max(_STRETCH * usual, _ABOVE_NOISE * noise)
