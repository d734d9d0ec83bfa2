"""How long noise lasts: a share of it is new in every frame, the rest is forgotten slowly.

Noise of unit sd is √(1 − w) x + √w e: x is AR(1) with correlation ρ over a median frame interval, e
is white. A camera's detection error is white, changing light and vibration last, rounding is white
beside both. Its correlation over a gap of g intervals is (1 − w) ρ^g.
"""

from typing import NamedTuple

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from softfinger.compiled import compiled


class Memory(NamedTuple):
    """ρ in [0, 1) over a median frame interval, and the white share w in [0, 1)."""

    autocorrelation: float
    white: float = 0.0


def list_memories(noise: xr.Dataset) -> list[Memory]:
    """List the memory of each joint's noise."""
    rho, white = (noise[f"noise_{name}"].values for name in ("autocorrelation", "white"))
    return [Memory(float(r), float(w)) for r, w in zip(rho, white, strict=True)]


def correlate_frames(memory: Memory, gap: NDArray[np.float64]) -> NDArray[np.float64]:
    """Correlation (n,) of frames a gap (n,) apart; 0 where it is infinite.

    >>> correlate_frames(Memory(0.5, 0.2), np.array([1.0, np.inf])).tolist()
    [0.4, 0.0]
    """
    return (1.0 - memory.white) * np.where(np.isfinite(gap), memory.autocorrelation**gap, 0.0)


def whiten_array(
    rows: NDArray[np.float64], gap: NDArray[np.float64], memory: Memory
) -> tuple[NDArray[np.float64], float]:
    """Whiten the rows of a series with such noise.

    The rows are (n, k), the noise has unit sd; W with WᵀW = R⁻¹.

    Each row less its best prediction from those before, over the sd of that (Kalman's filter). An
    infinite gap forgets all.

    Parameters
    ----------
    rows
        (n, k).
    gap
        (n,) time since the row before, in median frame intervals; the first is not read.

    Returns
    -------
    whitened, logdet : (n, k) and log|R|.

    Examples
    --------
    >>> white, logdet = whiten_array(
    ...     np.array([[1.0], [1.0]]), np.array([np.inf, 1.0]), Memory(0.6))
    >>> white.ravel().round(9), round(logdet, 6)
    (array([1. , 0.5]), -0.446287)
    """
    rows, gap = np.ascontiguousarray(rows, float), np.asarray(gap, float)
    white = np.empty_like(rows)
    return white, fill_white(rows, gap, *map(float, memory), white)


@compiled
def update_doubt(unsure: float, carried: float, share: float) -> tuple[float, float, float]:
    """Doubt about what lasts, from one frame to the next.

    Variances of `whiten_array`'s noise: `unsure` of what lasts after the frame before, `carried` of
    it its correlation with now, `share` the white share.

    Returns
    -------
    spread, gain, unsure
        The frame's variance about its prediction, what of its surprise is taken to last, and the
        doubt after it.
    """
    unsure = carried * carried * unsure + (1.0 - share) * (1.0 - carried * carried)
    spread = unsure + share
    gain = unsure / spread
    return spread, gain, unsure * (1.0 - gain)


@compiled
def fill_white(rows: NDArray, gap: NDArray, rho: float, share: float, white: NDArray) -> float:
    """Fill `white` (n, k) with the whitened rows, and return log|R|."""
    logdet, unsure, state = 0.0, 0.0, np.zeros(rows.shape[1])
    for i in range(rows.shape[0]):
        carried = 0.0 if i == 0 else rho ** gap[i]
        spread, gain, unsure = update_doubt(unsure, carried, share)
        logdet += np.log(spread)
        for k in range(rows.shape[1]):
            new = rows[i, k] - carried * state[k]
            white[i, k] = new / np.sqrt(spread)
            state[k] = carried * state[k] + gain * new
    return logdet
