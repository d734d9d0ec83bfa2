"""Two parts of the angle as point masses.

They are its elastic and its flowing part, fit to be smoothed and added.

Masses of a log-normal lie at s = ℓ log(1 + exp w), even in w. That is even in log s where s is
small, where the log-normal is the narrower function, and even in s where the Gaussian that smooths
them is. Far tails then cost one mass per Gaussian width within the window, and nothing beyond it.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.special import expit, ndtr

from softfinger.mechanics.three_element import compute_elastic_basis_array
from softfinger.propagation.lattice import fill_lognormal_mixture
from softfinger.propagation.moments import C_V, K_V
from softfinger.propagation.quadrature import compute_normal_weights

REACH = 6.5  # sd of every normal population that is laid out; 8e-11 lies beyond
STEP = 0.85  # of the narrower of two Gaussians: the trapezoidal rule errs by 1e-12 of it
LOG_STEP = 0.45  # stays clear of the singularities of log(1 + exp w), log e at Im = π, π/2
NOTHING = 1e-9  # of the smoothing Gaussian's sd: masses so close to 0 are put there
PANEL_POINTS = 16


class Masses(NamedTuple):
    """Point masses (m,) at places (m,) [rad].

    `below` is the mass that lies below all limits.
    """

    place: NDArray[np.float64]
    mass: NDArray[np.float64]
    below: float


class ElasticMixture(NamedTuple):
    """E at each time as a mixture.

    It is a mixture over x = log(k_v/c_v) of log-normals of equal log-sd.

    weight (m,); log_median (m, n), −inf where E is 0; sign (m, n); typical (n,) [rad] is |E| at
    the median parameters.
    """

    weight: NDArray[np.float64]
    log_median: NDArray[np.float64]
    sign: NDArray[np.float64]
    log_sd: float
    typical: NDArray[np.float64]


def build_elastic_mixture(
    mu: NDArray[np.float64],
    sigma: NDArray[np.float64],
    time: NDArray[np.float64],
    load_time: ArrayLike,
    load_torque: ArrayLike,
    sd: float,
    fineness: float,
) -> ElasticMixture:
    """Build the log-normal mixture of the elastic part.

    With s² = σ_k² + σ_c²: log k_v | x ~ N(μ_k + (σ_k²/s²)(x − μ_x), σ_k² σ_c²/s²). The step in x
    shrinks until it resolves the product of two Gaussians: that of x, and that of an angle about
    its median, as wide as the log-normal and the smoothing `sd` together.
    """
    spread = np.hypot(sigma[K_V], sigma[C_V])
    log_sd = sigma[K_V] * sigma[C_V] / spread
    step = LOG_STEP / fineness
    while True:
        half = int(np.ceil(REACH * spread / step))
        x = step * np.arange(-half, half + 1)  # about μ_x
        rate = np.exp(mu[K_V] - mu[C_V] + x)
        lagged = compute_elastic_basis_array(rate, time, load_time, load_torque)[0]
        median = lagged * np.exp(-mu[K_V] - (sigma[K_V] / spread) ** 2 * x)[:, None]
        size = np.abs(median)
        width = np.hypot(log_sd * np.maximum(size[1:], size[:-1]), sd)
        gap = (np.abs(np.diff(median, axis=0)) / width).max(initial=0.0)
        ratio = np.hypot(gap, step / spread) * fineness / STEP
        if ratio <= 1.0:
            break
        step /= min(1.2 * ratio, 8.0)
    with np.errstate(divide="ignore"):
        log_median = np.log(size)
    weight = compute_normal_weights(x, 0.0, spread)
    return ElasticMixture(weight, log_median, np.sign(median), log_sd, size[half])


def lay_elastic_masses(
    mixture: ElasticMixture, row: int, sd: float, limits: tuple[float, float], fineness: float
) -> Masses:
    """Lay out E at time `row` within limits.

    Limits are in [rad], for smoothing by a Gaussian of `sd` [rad].
    """
    log_median, log_sd = mixture.log_median[:, row], mixture.log_sd
    nothing = np.log(NOTHING * sd)
    vanishing = log_median + REACH * log_sd < nothing
    places, masses = [np.zeros(1)], [np.array([mixture.weight[vanishing].sum()])]
    below = mixture.weight[(mixture.sign[:, row] < 0) & ~vanishing].sum()
    for sign, bound in ((1.0, limits[1]), (-1.0, -limits[0])):
        chosen = (mixture.sign[:, row] == sign) & ~vanishing
        if not chosen.any() or bound <= 0:
            continue
        medians = np.ascontiguousarray(log_median[chosen])
        low = max(medians.min() - REACH * log_sd, nothing - 2 * REACH * log_sd)
        high = min(medians.max() + REACH * log_sd, np.log(bound))
        if low >= high:
            continue
        place, cell = _space_nodes(low, high, log_sd, sd, fineness)
        mass = np.zeros(place.size)
        fill_lognormal_mixture(
            mixture.weight[chosen], medians, log_sd, REACH, np.log(place), cell / place, mass
        )
        places.append(sign * place)
        masses.append(mass)
        below -= mass.sum() if sign < 0 else 0.0
    return Masses(np.concatenate(places), np.concatenate(masses), max(below, 0.0))


def lay_flow_masses(
    median: float,
    log_sd: float,
    sd: float,
    limits: tuple[float, float],
    fineness: float,
    truncation_sd: float | None,
) -> Masses:
    """Lay out C = I/c_p of a median [rad]."""
    bound = limits[1] if median > 0 else -limits[0]
    reach = REACH if truncation_sd is None else truncation_sd
    if abs(median) < NOTHING * sd * np.exp(-min(reach, REACH) * log_sd):
        return Masses(np.zeros(1), np.ones(1), 0.0)
    centre = np.log(abs(median))
    low, high = centre - reach * log_sd, centre + reach * log_sd
    if bound <= 0 or np.log(bound) <= low:
        return Masses(np.zeros(0), np.zeros(0), float(median < 0))
    if truncation_sd is None:
        place, cell = _space_nodes(low, min(high, np.log(bound)), log_sd, sd, fineness)
        share = 1.0
    else:
        place, cell = _space_panels(low, min(high, np.log(bound)), log_sd, sd, fineness)
        share = ndtr(reach) - ndtr(-reach)
    z = (np.log(place) - centre) / log_sd
    density = np.exp(-0.5 * z * z) / (np.sqrt(2 * np.pi) * log_sd * share * place)
    mass = density * cell
    below = max(1.0 - mass.sum(), 0.0) if median < 0 else 0.0
    return Masses(np.sign(median) * place, mass, below)


def _space_nodes(
    low: float, high: float, log_sd: float, sd: float, fineness: float
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Places of the masses, and their cells.

    Places (m,) [rad] go from exp(low) to exp(high); cells ds (m,) are in [rad].
    """
    step, scale = _find_steps(log_sd, sd, fineness)
    ends = _find_abscissa(np.exp(np.array([low, high])) / scale)
    w = np.arange(np.floor(ends[0] / step), np.ceil(ends[1] / step) + 1) * step
    return scale * np.logaddexp(0.0, w), step * scale * expit(w)


def _space_panels(
    low: float, high: float, log_sd: float, sd: float, fineness: float
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Places as `_space_nodes`, by Gauss–Legendre panels."""
    step, scale = _find_steps(log_sd, sd, fineness)
    ends = _find_abscissa(np.exp(np.array([low, high])) / scale)
    panels = int(np.ceil((ends[1] - ends[0]) / (0.5 * PANEL_POINTS * step)))
    edges = np.linspace(*ends, panels + 1)
    point, weight = np.polynomial.legendre.leggauss(PANEL_POINTS)
    half = np.diff(edges)[:, None] / 2
    w = ((edges[1:] + edges[:-1])[:, None] / 2 + half * point).ravel()
    return scale * np.logaddexp(0.0, w), (half * weight).ravel() * scale * expit(w)


def _find_steps(log_sd: float, sd: float, fineness: float) -> tuple[float, float]:
    """Step in w, and ℓ [rad].

    Neighbours are then `step` apart in log s, or STEP sd in s.
    """
    step = min(STEP * log_sd, LOG_STEP) / fineness
    return step, STEP * sd / fineness / step


def _find_abscissa(ratio: NDArray[np.float64]) -> NDArray[np.float64]:
    """Compute w from s/ℓ.

    It is the inverse of log(1 + exp w), and neither overflows nor loses small values.
    """
    return ratio + np.log(-np.expm1(-ratio))
