"""Bounded effects φ as unbounded numbers.

The numbers are scaled by what a fit knows of φ.

With w the sd of φ by a fit, s(x) = log(1 + eˣ) and W = (high − low)/w,

    φ = low + w [s(u) − s(u − W)],   φ = high − w s(−u) without a lower bound,   φ = w u without any

is linear away from the bounds and bends within about w of them. So a number that may be null
is about as easy to draw as one that is not. The fit's mode and covariance then give centre and
root, u = u* + L z, which makes z about standard normal. The formulas take numpy and PyTensor.
"""

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

Array = Any  # of numpy or of PyTensor
CLEAR = 1.0  # sd: a mode nearer to a bound is taken to lie that far inside
LEAST_SD = 1e-12  # a fit that knows a number exactly
ENDLESS = 1e30  # W where a bound is absent


class Bounded(NamedTuple):
    """Bounds and scale (p,) of the unbounded numbers.

    Also their centre u* (p,) and root L (p, p).
    """

    low: NDArray[np.float64]
    high: NDArray[np.float64]
    scale: NDArray[np.float64]
    centre: NDArray[np.float64]
    root: NDArray[np.float64]

    def bind(self, number: NDArray[np.float64]) -> NDArray[np.float64]:
        """Effects (…, p) of unbounded numbers."""
        return bind(number, self.low, self.high, self.scale)

    def log_slope(self, number: NDArray[np.float64]) -> NDArray[np.float64]:
        """Logarithm of dφ/du (…, p)."""
        return log_slope(number, self.low, self.high, self.scale)


def place_effects(
    mode: NDArray[np.float64],
    covariance: NDArray[np.float64],
    low: NDArray[np.float64],
    high: NDArray[np.float64],
) -> Bounded:
    """Place unbounded numbers by a fit.

    The fit gives the mode (p,) and the covariance (p, p).

    Examples
    --------
    Without bounds, a number over its sd:

    >>> far = np.full(1, np.inf)
    >>> place_effects(np.ones(1), np.full((1, 1), 4.0), -far, far)[2:]
    (array([2.]), array([0.5]), array([[1.]]))
    """
    scale = np.maximum(np.sqrt(np.diag(covariance)), LEAST_SD)
    clear = np.minimum(CLEAR * scale, (high - low) / 4)
    inside = np.clip(mode, low + clear, high - clear)
    centre = unbind(inside, low, high, scale)
    if not len(mode):
        return Bounded(low, high, scale, centre, np.zeros((0, 0)))
    root = np.linalg.cholesky(covariance + np.diag(LEAST_SD * scale**2))
    slope = np.exp(log_slope(centre, low, high, scale))
    return Bounded(low, high, scale, centre, root / slope[:, None])


def unbind(
    effect: NDArray[np.float64],
    low: NDArray[np.float64],
    high: NDArray[np.float64],
    scale: NDArray[np.float64],
) -> NDArray[np.float64]:
    """Unbounded numbers (…, p) of effects within bounds.

    >>> one = np.ones(1)
    >>> low, high = 0 * one, np.inf * one
    >>> bind(unbind(2 * one, low, high, one), low, high, one).round(9)
    array([2.])
    """
    with np.errstate(invalid="ignore", over="ignore"):
        up, down = (effect - low) / scale, (high - effect) / scale
        both = up + np.log(-np.expm1(-up)) - np.log(-np.expm1(-down))
        above = -(down + np.log(-np.expm1(-down)))
    one = np.where(np.isfinite(low), both, above)
    return np.where(np.isinf(low) & np.isinf(high), effect / scale, one)


def bind(number: Array, low: Array, high: Array, scale: Array, module: Any = np) -> Array:  # noqa: ANN401
    """Effects (…, p) of unbounded numbers.

    `module` is numpy or PyTensor's tensor.
    """
    bottom, top, whole = _read_bounds(low, high, scale, module)
    lower = bottom + scale * (_soften(number, module) - _soften(number - whole, module))
    upper = top - scale * _soften(-number, module)
    one = module.where(module.isinf(low), upper, lower)
    return module.where(module.isinf(low) & module.isinf(high), scale * number, one)


def log_slope(number: Array, low: Array, high: Array, scale: Array, module: Any = np) -> Array:  # noqa: ANN401
    """Logarithm of dφ/du (…, p) of `bind`."""
    _, _, whole = _read_bounds(low, high, scale, module)
    lower = number - _soften(number, module) - _soften(number - whole, module)
    lower = lower + module.log(-module.expm1(-whole))
    one = module.where(module.isinf(low), -_soften(number, module), lower)
    free = module.isinf(low) & module.isinf(high)
    return module.log(scale) + module.where(free, 0.0 * number, one)


def _read_bounds(low: Array, high: Array, scale: Array, module: Any) -> tuple:  # noqa: ANN401
    """Bounds, 0 where there are none, and W."""
    bottom = module.where(module.isinf(low), 0.0, low)
    top = module.where(module.isinf(high), 0.0, high)
    open_ended = module.isinf(low) | module.isinf(high)
    return bottom, top, module.where(open_ended, ENDLESS, (top - bottom) / scale)


def _soften(x: Array, module: Any) -> Array:  # noqa: ANN401
    """log(1 + eˣ), without overflow."""
    return module.maximum(x, 0.0) + module.log1p(module.exp(-module.abs(x)))
