"""The density of a sample, by Gaussian kernel."""

import numpy as np
from numpy.typing import ArrayLike, NDArray

from softfinger.propagation import lattice


def estimate_density_array(sample: ArrayLike, angle: ArrayLike) -> NDArray[np.float64]:
    """Estimate the density (a,) [1/rad] of a sample.

    Parameters
    ----------
    sample
        (m,) [rad], NaN = unknown.
    angle
        (a,) [rad]

    References
    ----------
    Silverman (1986), Density Estimation for Statistics and Data Analysis, eq. 3.31.
    """
    sample, angle = np.asarray(sample, float), np.ascontiguousarray(angle, float)
    sample = sample[np.isfinite(sample)]
    spread = np.diff(np.quantile(sample, (0.25, 0.75)))[0] / 1.349
    width = 0.9 * max(min(sample.std(), spread), 1e-9) * sample.size**-0.2
    return smooth_sample_array(sample, width, angle)


def smooth_sample_array(
    sample: NDArray[np.float64], sd: float, angle: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Compute the density of a blurred sample.

    It is (a,) [1/rad], of sample + N(0, sd²).

    Examples
    --------
    >>> smooth_sample_array(np.zeros(2), 0.5, np.array([0.0, 0.5])).round(4)
    array([0.7979, 0.4839])
    """
    part = sd / np.sqrt(2)  # one half of the variance on to the lattice, one half off it
    edges = np.floor(np.array([angle.min(), angle.max()]) / part * lattice.PER_SD).astype(int)
    start = int(edges[0]) - 2 * lattice.WIDTH
    density = np.zeros(int(edges[1]) + 2 * lattice.WIDTH - start)
    mass = np.full(sample.size, 1 / sample.size)
    lattice.lay_masses(sample, mass, part, start, density, lattice.TAPER)
    return lattice.read_density(angle, density, part, start, lattice.TAPER)
