"""Masses on a line, smoothed on to a lattice.

A Gaussian smooths them; another one reads them off.

A Gaussian of sd σ sampled at σ/2 is band-limited to exp(−2π²) = 3e-9, so that laying masses on the
lattice, convolving there and reading the result anywhere through a third Gaussian are all exact to
that order. This is the fast Gaussian gridding of non-uniform Fourier transforms; here the Gaussians
are not an artifice, they are the three thirds of the normal initial angle's own variance.

References
----------
Greengard, Lee (2004), SIAM Review 46, 443, doi:10.1137/S003614450343200X.
"""

import math

import numpy as np
from numpy.typing import NDArray

from softfinger.compiled import compiled

PER_SD = 2  # lattice points per sd of the Gaussian
WIDTH = 13  # lattice points on either side: 6.5 sd, 7e-10 of the Gaussian's peak
# the Gaussian about a mass, at the lattice points around it
TAPER = np.exp(-0.5 * (np.arange(-WIDTH, WIDTH + 2) / PER_SD) ** 2)


@compiled
def lay_masses(
    place: NDArray, mass: NDArray, sd: float, start: int, lattice: NDArray, taper: NDArray
) -> None:
    """Add smoothed masses to a density.

    They lie at `place` (m,), and a Gaussian smooths them on to the lattice points.

    Point i of `lattice` lies at (start + i) · sd/2. `taper` is TAPER.
    """
    scale = 1.0 / (sd * math.sqrt(2 * math.pi))
    for j in range(place.size):
        if mass[j] == 0.0:
            continue
        position = place[j] / sd * PER_SD
        below = math.floor(position)
        rest = (position - below) / PER_SD  # in sd, 0 … 1/PER_SD
        ratio = math.exp(rest / PER_SD)
        # exp(−(rest − m/2)²/2) = exp(−rest²/2) · ratio^m · exp(−m²/8)
        value = mass[j] * scale * math.exp(-0.5 * rest * rest) * ratio ** (-WIDTH)
        first = int(below) - start - WIDTH
        for m in range(taper.size):
            if 0 <= first + m < lattice.size:
                lattice[first + m] += value * taper[m]
            value *= ratio


@compiled
def read_density(
    angle: NDArray, lattice: NDArray, sd: float, start: int, taper: NDArray
) -> NDArray:
    """Read the smoothed density at angles (a,)."""
    scale = 1.0 / (PER_SD * math.sqrt(2 * math.pi))
    density = np.zeros(angle.size)
    for j in range(angle.size):
        position = angle[j] / sd * PER_SD
        below = math.floor(position)
        rest = (position - below) / PER_SD
        ratio = math.exp(rest / PER_SD)
        value = scale * math.exp(-0.5 * rest * rest) * ratio ** (-WIDTH)
        first = int(below) - start - WIDTH
        for m in range(taper.size):
            if 0 <= first + m < lattice.size:
                density[j] += value * taper[m] * lattice[first + m]
            value *= ratio
    return density


@compiled
def read_probability(angle: NDArray, lattice: NDArray, sd: float, start: int) -> NDArray:
    """Read the probability below angles (a,)."""
    cumulated = np.cumsum(lattice)
    probability = np.empty(angle.size)
    for j in range(angle.size):
        probability[j] = _sum_below(angle[j] / sd * PER_SD - start, lattice, cumulated)
    return probability * sd / PER_SD


@compiled
def find_quantiles(
    probability: NDArray, lattice: NDArray, sd: float, start: int, low: float, high: float
) -> NDArray:
    """Find by bisection the angles of given probabilities.

    The angles (p,) lie between two others; below each lies its probability.
    """
    cumulated = np.cumsum(lattice)
    quantile = np.empty(probability.size)
    for j in range(probability.size):
        left, right = low / sd * PER_SD - start, high / sd * PER_SD - start
        wanted = probability[j] / sd * PER_SD
        while right - left > 1e-9 + 1e-15 * abs(left):
            middle = 0.5 * (left + right)
            if _sum_below(middle, lattice, cumulated) < wanted:
                left = middle
            else:
                right = middle
        quantile[j] = (0.5 * (left + right) + start) * sd / PER_SD
    return quantile


@compiled
def _sum_below(position: float, lattice: NDArray, cumulated: NDArray) -> float:
    below = math.floor(position)
    first = min(max(below - WIDTH, 0), lattice.size)
    last = min(max(below + WIDTH + 2, 0), lattice.size)
    total = cumulated[first - 1] if first > 0 else 0.0
    for i in range(first, last):
        total += lattice[i] * 0.5 * math.erfc((i - position) / (PER_SD * math.sqrt(2.0)))
    return total


@compiled
def fill_lognormal_mixture(
    weight: NDArray,
    log_median: NDArray,
    log_sd: float,
    reach: float,
    log_place: NDArray,
    log_width: NDArray,
    mass: NDArray,
) -> None:
    """Add a mixture of log-normals to `mass` (node,).

    Its log-normals have equal log-sd; each node gets the mass that it puts there.

    `log_place` (node,), rising: log of each node's place; `log_width`: its cell in the logarithm.
    """
    scale = 1.0 / (log_sd * math.sqrt(2 * math.pi))
    for i in range(weight.size):
        first = np.searchsorted(log_place, log_median[i] - reach * log_sd)
        for j in range(first, log_place.size):
            z = (log_place[j] - log_median[i]) / log_sd
            if z > reach:
                break
            mass[j] += weight[i] * scale * log_width[j] * math.exp(-0.5 * z * z)
