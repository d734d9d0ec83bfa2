"""Densities and indices of any forward model, from samples, each with its own error.

For models that are no sum of independent parts: an angle-dependent moment arm, a stop, a repaired
model. The paper's joint has exact routes (`density`, `indices`), against which these are checked.
"""

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.stats import sobol_indices
from scipy.stats import t as student_t

from softfinger.propagation import lattice

REPLICATES = 8  # independently scrambled sequences; their scatter is the error


class EstimatedIndices(NamedTuple):
    """First-order and total indices (parameter, output) with half-widths of their 95 % bounds."""

    first_order: NDArray[np.float64]
    first_order_error: NDArray[np.float64]
    total: NDArray[np.float64]
    total_error: NDArray[np.float64]


def estimate_sobol_array(
    model: Callable[[NDArray[np.float64]], NDArray[np.float64]],
    populations: Sequence,
    n: int,
    rng: np.random.Generator,
) -> EstimatedIndices:
    """Estimate Sobol indices of any model of independent parameters (Saltelli's estimators).

    Parameters
    ----------
    model
        Parameters (m, parameter) → outputs (m, output).
    populations
        One frozen `scipy.stats` distribution per parameter.
    n
        A power of two, at least 16; the model is evaluated (parameters + 2) n times.

    Returns
    -------
    EstimatedIndices
        Means over eight independent runs of n/8; those below 0 or above 1, which is noise, are set
        to 0 or 1. NaN for an output that does not vary. The error is seen in the scatter of the
        runs; a heavy tail that no run met is not in it.

    References
    ----------
    Saltelli et al. (2010), Computer Physics Communications 181, 259,
    doi:10.1016/j.cpc.2009.09.018.

    Examples
    --------
    >>> uniform = __import__("scipy.stats").stats.uniform()
    >>> indices = estimate_sobol_array(
    ...     lambda x: x[:, :1] + 2 * x[:, 1:], [uniform] * 2, 1024, np.random.default_rng(1))
    >>> indices.first_order.ravel().round(2)
    array([0.2, 0.8])
    """
    runs = []
    for _ in range(REPLICATES):
        found = sobol_indices(
            func=lambda x: model(x.T).T, n=n // REPLICATES, dists=list(populations), rng=rng
        )
        shape = (-1, len(populations))
        runs.append([found.first_order.reshape(shape).T, found.total_order.reshape(shape).T])
    mean = np.mean(runs, axis=0)
    error = student_t.ppf(0.975, REPLICATES - 1) * np.std(runs, axis=0, ddof=1) / REPLICATES**0.5
    still = (mean[1] == 0).all(axis=0)  # total indices of what varies sum to 1 or more
    mean[..., still] = error[..., still] = np.nan
    first, total = np.clip(mean, 0.0, 1.0)
    return EstimatedIndices(first, error[0], total, error[1])


def estimate_density_array(
    sample: ArrayLike, sd: float, angle: ArrayLike
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Estimate the density of sample + N(0, sd²) at angles, with its standard error.

    If the angle holds an independent normal part, q_ini, leave that out of the sample and give its
    sd: the mean of the conditional densities, p(y) = mean φ((y − x_i)/sd)/sd, has no bias. Else
    give a small sd: a kernel density, with the bias sd² p″/2.

    Parameters
    ----------
    sample
        (m,) [rad], independent draws.
    angle
        (a,) [rad], less the mean of the normal part.

    Returns
    -------
    density, standard_error : (a,) [1/rad]

    Examples
    --------
    >>> density, error = estimate_density_array([0.0, 0.0], 0.5, [0.0, 0.5])
    >>> density.round(4), error.round(4)
    (array([0.7979, 0.4839]), array([0., 0.]))
    """
    sample, angle = np.ascontiguousarray(sample, float), np.ascontiguousarray(angle, float)
    density = _smooth(sample, sd, angle)
    # φ² is a Gaussian again, of sd/√2 and of weight 1/(2 sd √π)
    square = _smooth(sample, sd / np.sqrt(2), angle) / (2 * sd * np.sqrt(np.pi))
    variance = np.maximum(square - density**2, 0.0)
    variance[variance < 1e-7 * square] = 0.0  # nothing but the lattice's own error
    return density, np.sqrt(variance / sample.size)


def _smooth(sample: NDArray, sd: float, angle: NDArray) -> NDArray[np.float64]:
    part = sd / np.sqrt(2)  # one half of the variance on to the lattice, one half off it
    edges = np.floor(np.array([angle.min(), angle.max()]) / part * lattice.PER_SD).astype(int)
    start = int(edges[0]) - 2 * lattice.WIDTH
    density = np.zeros(int(edges[1]) + 2 * lattice.WIDTH - start)
    mass = np.full(sample.size, 1 / sample.size)
    lattice.lay_masses(sample, mass, part, start, density, lattice.TAPER)
    return lattice.read_density(angle, density, part, start, lattice.TAPER)
