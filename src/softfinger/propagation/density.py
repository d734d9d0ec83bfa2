"""The density of the joint angle.

It follows by random variable transformation and is exact for the paper's joint.

    q = E + C + Q,   E = e(t; k_v/c_v)/k_v,   C = I/c_p,   Q = q_ini,   I = ∫u dt

Given x = log(k_v/c_v), log k_v is normal, so that E is a one-dimensional mixture of log-normals; C
is log-normal in closed form; Q is normal. Each of E and C is laid out as point masses (`masses`),
smoothed by one third of Q's variance on to a lattice; both are convolved by FFT, and the last third
reads the density off at any angle (`lattice`). All of it converges exponentially.

Misprint: the paper's log-normal density lacks the minus sign of its exponent; it is
exp(−(log x − μ)²/(2σ²)) / (x σ √(2π)).

ASSUME: k_v, c_v, c_p and q_ini are independent of each other within a population. A normal Q
narrower than 1e-3 of the spread of E + C is widened to that, which costs 5e-7 of the peak; so is
one narrower than 1e-5 of the angles asked for, where only a far tail can be meant.
"""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy import fft

from softfinger.faults import Fault
from softfinger.mechanics.load import integrate_load_array
from softfinger.propagation import lattice
from softfinger.propagation.masses import (
    REACH,
    Masses,
    build_elastic_mixture,
    lay_elastic_masses,
    lay_flow_masses,
)
from softfinger.propagation.moments import C_P, Q_INI

NARROWEST = 1e-3
MOST_SD = 1e5
REFINEMENT = 1.5
MOST_REFINEMENTS = 5


class Distribution(NamedTuple):
    """Density of the angle on a lattice.

    The density lacks its last third of smoothing. Its points are (start + i) sd/2.

    `centre` is the mean of q_ini [rad], to be taken off an angle before it is looked up, and
    `below` the probability of angles too low to be on the lattice.
    """

    density: NDArray[np.float64]
    start: int
    sd: float
    centre: float
    below: float

    def read_density(self, angle: NDArray[np.float64]) -> NDArray[np.float64]:
        """Density [1/rad] at angles (a,) [rad]."""
        place = np.ascontiguousarray(angle - self.centre)
        density = lattice.read_density(place, self.density, self.sd, self.start, lattice.TAPER)
        return np.maximum(density, 0.0)  # the FFT rounds far tails to ±1e-16

    def read_probability(self, angle: NDArray[np.float64]) -> NDArray[np.float64]:
        """Probability of less than angles (a,) [rad]."""
        place = np.ascontiguousarray(angle - self.centre)
        return self.below + lattice.read_probability(place, self.density, self.sd, self.start)

    def find_quantiles(
        self, probability: NDArray[np.float64], low: float, high: float
    ) -> NDArray[np.float64]:
        """Angles (p,) [rad] of given probabilities.

        They lie between two others; below each angle lies its probability.
        """
        wanted, ends = probability - self.below, (low - self.centre, high - self.centre)
        found = lattice.find_quantiles(wanted, self.density, self.sd, self.start, *ends)
        return found + self.centre


def compute_density_array(
    mu: ArrayLike,
    sigma: ArrayLike,
    time: ArrayLike,
    load_time: ArrayLike,
    load_torque: ArrayLike,
    angle: ArrayLike,
    c_p_truncation_sd: float | None = None,
    fineness: float = 1.0,
) -> NDArray[np.float64]:
    """Compute the density of the joint angle.

    It is that of one population at each time.

    Parameters
    ----------
    mu, sigma
        (4,) in the order k_v, c_v, c_p (of their logs), q_ini [rad]; NaN gives NaN.
    time
        (n,) [s].
    load_time, load_torque
        (knot,) [s], [N m].
    angle
        (a,) or (n, a) [rad].
    c_p_truncation_sd
        Keep |log c_p − μ| ≤ this many σ only; None keeps all.
    fineness
        Divides every step of the quadratures.

    Returns
    -------
    (n, a) [1/rad]

    Examples
    --------
    Before the load has acted the angle is the initial one, N(0.02, 0.01) rad:

    >>> density = compute_density_array(
    ...     [-2.4, -3.7, 2.9, 0.02], [0.2, 0.5, 0.7, 0.01], [0.0], [0.0], [0.04], [0.02, 0.03])
    >>> density.round(6)
    array([[39.894228, 24.197072]])
    """
    time, angle = np.asarray(time, float), np.asarray(angle, float)
    angle = np.broadcast_to(angle, (time.size, angle.shape[-1]))
    window = (angle.min(axis=1), angle.max(axis=1))
    parts = convolve_parts(
        mu, sigma, time, load_time, load_torque, window, c_p_truncation_sd, fineness
    )
    density = np.full(angle.shape, np.nan)
    for row, part in enumerate(parts):
        density[row] = part.read_density(angle[row])
    return density


def refine_density_array(
    mu: ArrayLike,
    sigma: ArrayLike,
    time: ArrayLike,
    load_time: ArrayLike,
    load_torque: ArrayLike,
    angle: ArrayLike,
    c_p_truncation_sd: float | None = None,
    tolerance: float = 1e-6,
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Compute the density with refined quadratures.

    Parameters
    ----------
    mu, sigma, time, load_time, load_torque, angle, c_p_truncation_sd
        As for `compute_density_array`.
    tolerance
        Of the density's peak among the angles.

    Returns
    -------
    density (n, a) [1/rad], and its error (n,) over the peak: the largest change that the last
    refinement made.

    Raises
    ------
    Fault
        If five refinements are not enough.
    """
    population = (mu, sigma, time, load_time, load_torque, angle, c_p_truncation_sd)
    density, fineness = compute_density_array(*population), 1.0
    for _ in range(MOST_REFINEMENTS):
        fineness *= REFINEMENT
        finer = compute_density_array(*population, fineness=fineness)
        error = np.abs(finer - density).max(axis=1) / finer.max(axis=1)
        if not (error > tolerance).any():
            return finer, error
        density = finer
    raise Fault(
        f"the density of the joint angle still changes by {error.max():.1e} of its peak after "
        f"{MOST_REFINEMENTS} refinements; expected {tolerance:g}: report this population, mu = "
        f"{np.asarray(mu).tolist()}, sigma = {np.asarray(sigma).tolist()}"
    )


def convolve_parts(
    mu: ArrayLike,
    sigma: ArrayLike,
    time: NDArray[np.float64],
    load_time: ArrayLike,
    load_torque: ArrayLike,
    window: tuple[NDArray[np.float64], NDArray[np.float64]],
    c_p_truncation_sd: float | None = None,
    fineness: float = 1.0,
) -> Iterator[Distribution]:
    """Yield the distribution of the angle at times.

    `window` contains the least and the largest angle (n,) [rad] at each time; the other arguments
    are those of `compute_density_array`. Nothing is yielded for a population that is not known.
    """
    mu, sigma = np.asarray(mu, float), np.asarray(sigma, float)
    if not (np.isfinite(mu).all() and (sigma > 0).all()):
        return
    impulse = integrate_load_array(time, load_time, load_torque)
    flow = impulse * np.exp(-mu[C_P])  # its median
    mixture = build_elastic_mixture(
        mu, sigma, time, load_time, load_torque, sigma[Q_INI] / np.sqrt(3), fineness
    )
    for row in range(time.size):
        spread = max(
            abs(flow[row]) * min(sigma[C_P], 1.0),
            mixture.typical[row] * min(mixture.log_sd, 1.0),
        )
        low, high = (edge[row] - mu[Q_INI] for edge in window)
        sd = max(sigma[Q_INI], NARROWEST * spread, (high - low) / MOST_SD) / np.sqrt(3)
        limits = _limit_parts(low - 3 * REACH * sd, high + 3 * REACH * sd, flow[row], mixture, row)
        elastic = lay_elastic_masses(mixture, row, sd, limits, fineness)
        creep = lay_flow_masses(flow[row], sigma[C_P], sd, limits, fineness, c_p_truncation_sd)
        yield _convolve(elastic, creep, sd, mu[Q_INI])


def _limit_parts(
    low: float, high: float, flow: float, mixture: NamedTuple, row: int
) -> tuple[float, float]:
    """Bounds beyond which a part cannot count.

    ASSUME: where E and C have opposite signs, values beyond twice the window do not cancel.
    """
    if flow >= 0 and (mixture.sign[:, row] >= 0).all():
        return 0.0, high
    if flow <= 0 and (mixture.sign[:, row] <= 0).all():
        return low, 0.0
    most = 2 * max(abs(low), abs(high))
    return -most, most


def _convolve(elastic: Masses, flow: Masses, sd: float, centre: float) -> Distribution:
    starts, densities = zip(*(_smooth(part, sd) for part in (elastic, flow)), strict=True)
    n = sum(density.size for density in densities) - 1
    size = fft.next_fast_len(n, real=True)
    spectrum = fft.rfft(densities[0], size) * fft.rfft(densities[1], size)
    density = fft.irfft(spectrum, size)[:n] * sd / lattice.PER_SD
    below = 1 - (1 - elastic.below) * (1 - flow.below)
    return Distribution(density, sum(starts), sd, centre, below)


def _smooth(part: Masses, sd: float) -> tuple[int, NDArray[np.float64]]:
    if part.place.size == 0:
        return 0, np.zeros(1)
    edges = np.floor(np.array([part.place.min(), part.place.max()]) / sd * lattice.PER_SD)
    start = int(edges[0]) - lattice.WIDTH
    density = np.zeros(int(edges[1]) + lattice.WIDTH + 2 - start)
    lattice.lay_masses(part.place, part.mass, sd, start, density, lattice.TAPER)
    return start, density
