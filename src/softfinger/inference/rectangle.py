"""Probability that a normal vector lies within bounds.

The method is expectation propagation.

Each bound is replaced by a normal factor that gives the right moments beside all the others. Exact
for one number and for independent ones; for orthants of three correlated ones the tests allow 2 %.

References
----------
Cunningham, Hennig, Lacoste-Julien (2011), arXiv:1111.6832.
"""

import math

import numpy as np
from numpy.typing import NDArray

from softfinger.compiled import compiled

ROUNDS = 60
RESTS = 1e-8  # relative change of the factors' precision at which the rounds end
FAR = 35.0  # sd beyond which a normal tail is its asymptotic series


@compiled(error_model="numpy")
def measure_rectangle(mean: NDArray, covariance: NDArray, low: NDArray, high: NDArray) -> float:
    """Log probability that a normal vector lies between bounds.

    Parameters
    ----------
    mean, covariance
        (p,), (p, p).
    low, high
        (p,), may be infinite.

    Examples
    --------
    Two numbers with correlation −0.5 are both positive once in six.

    >>> pair = np.array([[1.0, -0.5], [-0.5, 1.0]])
    >>> round(np.exp(measure_rectangle(np.zeros(2), pair, np.zeros(2), np.full(2, np.inf))), 3)
    np.float64(0.167)
    """
    bound = np.flatnonzero(np.isfinite(low) | np.isfinite(high))  # no other cuts anything off
    p = len(bound)
    if p == 0:
        return 0.0
    low, high, mean = low[bound], high[bound], mean[bound]
    covariance = np.ascontiguousarray(covariance[bound][:, bound])
    precision, pull = np.zeros(p), np.zeros(p)  # of the factors
    log_factor = np.zeros(p)
    now, place = covariance.copy(), mean.copy()
    for _ in range(ROUNDS):
        moved = 0.0
        for i in range(p):
            if now[i, i] <= 0.0 or 1.0 / now[i, i] <= precision[i]:
                continue
            cavity = 1.0 / now[i, i] - precision[i]
            centre, variance = (place[i] / now[i, i] - pull[i]) / cavity, 1.0 / cavity
            log_mass, inner, spread = cut_normal(centre, variance, low[i], high[i])
            more = max(1.0 / spread - cavity, 0.0) - precision[i]
            further = inner / spread - centre * cavity - pull[i]
            precision[i] += more
            pull[i] += further
            total = cavity + precision[i]
            raised = (centre * cavity + pull[i]) ** 2 / total - centre**2 * cavity
            log_factor[i] = log_mass + 0.5 * (math.log(total / cavity) - raised)
            moved = max(moved, abs(more) / total)
            now -= more / (1.0 + more * now[i, i]) * np.outer(now[:, i], now[i])
            place += (further - more * place[i]) * now[:, i]
        if moved < RESTS:
            break
    square = mean @ (pull - precision * place) + place @ pull
    volume = np.linalg.slogdet(np.eye(p) + covariance @ np.diag(precision))[1]
    return log_factor.sum() + 0.5 * (square - volume)


@compiled(error_model="numpy")
def cut_normal(
    centre: float, variance: float, low: float, high: float
) -> tuple[float, float, float]:
    """Log mass of a normal between bounds.

    Also mean and variance of what lies there.
    """
    sd = math.sqrt(variance)
    a, b = (low - centre) / sd, (high - centre) / sd
    if a + b < 0.0:  # the side on which tails lose no digits
        log_mass, inner, spread = cut_normal(-centre, variance, -high, -low)
        return log_mass, -inner, spread
    tail, other = _log_tail(a), _log_tail(b)
    log_mass = tail + math.log1p(-math.exp(other - tail)) if other > -np.inf else tail
    here = math.exp(_log_density(a) - log_mass) if a > -np.inf else 0.0
    there = math.exp(_log_density(b) - log_mass) if b < np.inf else 0.0
    shift = here - there
    share = 1.0 - shift**2
    if a > -np.inf:
        share += a * here
    if b < np.inf:
        share -= b * there
    if a > FAR:
        share = 1.0 / (a * a + 2.0)
    return log_mass, centre + sd * shift, variance * max(share, 1e-12)


@compiled(error_model="numpy")
def _log_density(x: float) -> float:
    return -0.5 * x * x - 0.5 * math.log(2.0 * math.pi)


@compiled(error_model="numpy")
def _log_tail(x: float) -> float:
    """Log of the standard normal's mass above x."""
    if x == np.inf:
        return -np.inf
    if x > FAR:
        return _log_density(x) - math.log(x) + math.log1p(-1.0 / (x * x + 3.0))
    return math.log(0.5 * math.erfc(x / math.sqrt(2.0)))
