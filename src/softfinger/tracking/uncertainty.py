r"""What a position's standard deviation really is.

A fit knows how the light's noise moves the centre if that noise is independent from pixel to pixel
and as strong on the rim as beside it. Coded pictures break both. The distances between markers on
one rigid link show how much the centres really scatter, whatever the finger does:

.. math:: f^2 = \frac{\langle (D_t - D_{t-1})^2 \rangle}{2 \langle σ_a^2 + σ_b^2 \rangle}

is the factor between actual and claimed variance of a link's markers.
"""

import numpy as np
from scipy.ndimage import median_filter, uniform_filter1d

from softfinger.tracking.body import Body
from softfinger.tracking.fit import MISFIT, NOISE_VARIANCE, UNIT_XX, UNIT_YY

_NOISE_WINDOW = 61  # frames over which the light's noise is taken for constant
_PRIOR_FRAMES = 100.0  # how many frames of distances a claim made without them is worth
_EXCESS = 2.0  # misfit over the typical one, beyond which it adds to the variance
_LARGEST_SHARE = 16.0  # of the median squared change: larger ones are faults, not noise
_NORMAL_SQUARE_MEDIAN = 0.4549364  # of a standard normal variable's square


def claim_sd_array(
    position: np.ndarray, quality: np.ndarray, stale: np.ndarray, body: Body
) -> np.ndarray:
    """Standard deviation of every position, either coordinate.

    Parameters
    ----------
    position : (frame, marker, 2) [px]
    quality : (frame, marker, 5)
        As given by the fits.
    stale : (frame,) bool
        Frames that repeat the one before.
    body : Body

    Returns
    -------
    (frame, marker) [px]
        NaN where a marker is not seen.
    """
    unit = 0.5 * (quality[..., UNIT_XX] + quality[..., UNIT_YY])
    variance = unit * _smooth_noise(quality[..., NOISE_VARIANCE])
    excess = compute_excess_array(quality)
    variance *= np.where(excess > _EXCESS, excess, 1.0)
    factor = measure_variance_factor_array(position, variance, stale, body)
    return np.sqrt(variance * factor)


def compute_excess_array(quality: np.ndarray) -> np.ndarray:
    """Mean square rim residual over its typical value.

    The typical value is that of the same marker (frame, marker).

    Parameters
    ----------
    quality : (frame, marker, 5)
    """
    residual = quality[..., MISFIT] * quality[..., NOISE_VARIANCE]
    typical = np.full(residual.shape[1], np.nan)
    for k, values in enumerate(residual.T):
        seen = values[np.isfinite(values)]
        typical[k] = np.median(seen) if seen.size else np.nan
    return residual / np.maximum(typical, 1e-12)


def measure_variance_factor_array(
    position: np.ndarray, variance: np.ndarray, stale: np.ndarray, body: Body
) -> np.ndarray:
    """Actual over claimed variance of markers (marker,).

    The links' rigidity shows the actual one.

    A link's own factor is drawn towards that of all links, and that towards one, by 100 frames'
    worth each.
    """
    fresh = ~stale
    squares = []
    for a, b in zip(body.first, body.second, strict=True):
        gap = np.hypot(*np.moveaxis(position[fresh, a] - position[fresh, b], -1, 0))
        claimed = variance[fresh, a] + variance[fresh, b]
        squares.append(np.diff(gap) ** 2 / (claimed[1:] + claimed[:-1]))
    counts, means = _average_robustly(squares)
    total = _PRIOR_FRAMES + counts.sum()
    pooled = (_PRIOR_FRAMES + (counts * means).sum()) / total
    factor = np.full(position.shape[1], pooled)
    for link in body.links:
        own = np.isin(body.first, link)
        weight = counts[own].sum()
        factor[list(link)] = (_PRIOR_FRAMES * pooled + (counts * means)[own].sum()) / (
            _PRIOR_FRAMES + weight
        )
    return factor


def _average_robustly(squares: list[np.ndarray]) -> tuple[np.ndarray, np.ndarray]:
    """Number and mean square of pairs' noisy changes."""
    counts, means = np.zeros(len(squares)), np.zeros(len(squares))
    for k, values in enumerate(squares):
        seen = values[np.isfinite(values)]
        if seen.size:
            limit = _LARGEST_SHARE / _NORMAL_SQUARE_MEDIAN * np.median(seen)
            kept = seen[seen <= limit]
            counts[k], means[k] = kept.size, kept.mean()
    return counts, means


def _smooth_noise(noise: np.ndarray) -> np.ndarray:
    """Running variance of light (frame, marker), outliers aside."""
    smooth = np.full_like(noise, np.nan)
    for k, values in enumerate(noise.T):
        seen = np.isfinite(values)
        if seen.any():
            size = min(_NOISE_WINDOW, 2 * ((seen.sum() - 1) // 2) + 1)
            typical = median_filter(values[seen], size, mode="nearest")
            calm = np.minimum(values[seen], 2.0 * typical)
            smooth[seen, k] = uniform_filter1d(calm, size, mode="nearest")
    return smooth
