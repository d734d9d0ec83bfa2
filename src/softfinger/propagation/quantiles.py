"""Quantiles of the joint angle from its exact distribution.

The window of angles grows until it contains them; each is taken from the first window that does, so
that far quantiles of a heavy tail, which need a wide and coarse lattice, do not blur the near ones.
"""

import numpy as np
from numpy.typing import ArrayLike, NDArray

from softfinger.propagation.density import convolve_parts
from softfinger.propagation.moments import Q_INI

FIRST_WINDOW = 8.0  # sd of q_ini to either side
MOST_DOUBLINGS = 40


def compute_quantiles_array(
    mu: ArrayLike,
    sigma: ArrayLike,
    time: ArrayLike,
    load_time: ArrayLike,
    load_torque: ArrayLike,
    probability: ArrayLike,
    c_p_truncation_sd: float | None = None,
) -> NDArray[np.float64]:
    """Compute quantiles of the joint angle.

    Parameters
    ----------
    mu, sigma, time, load_time, load_torque, c_p_truncation_sd
        As for `compute_density_array`.
    probability
        (p,)

    Returns
    -------
    (n, p) [rad]; NaN for a population that is not known.

    Examples
    --------
    >>> compute_quantiles_array(
    ...     [-2.4, -3.7, 2.9, 0.02], [0.2, 0.5, 0.7, 0.01], [0.0], [0.0], [0.04], [0.5, 0.975]
    ... ).round(6)
    array([[0.02  , 0.0396]])
    """
    mu, sigma = np.asarray(mu, float), np.asarray(sigma, float)
    time, probability = np.asarray(time, float), np.asarray(probability, float)
    load = (load_time, load_torque)
    quantile = np.full((time.size, probability.size), np.nan)
    reach = np.full((time.size, 2), FIRST_WINDOW * sigma[Q_INI])
    for _ in range(MOST_DOUBLINGS):
        waiting = np.flatnonzero(np.isnan(quantile).any(axis=1))
        window = (mu[Q_INI] - reach[waiting, 0], mu[Q_INI] + reach[waiting, 1])
        parts = convolve_parts(mu, sigma, time[waiting], *load, window, c_p_truncation_sd)
        for row, part, low, high in zip(waiting, parts, *window, strict=False):
            below = part.read_probability(np.array([low, high]))
            missing = np.isnan(quantile[row])
            found = missing & (probability >= below[0]) & (probability <= below[1])
            quantile[row, found] = part.find_quantiles(probability[found], low, high)
            reach[row, 0] *= 1 + (missing & (probability < below[0])).any()
            reach[row, 1] *= 1 + (missing & (probability > below[1])).any()
    return quantile
