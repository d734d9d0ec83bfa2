"""Quantiles of the joint angle from its exact distribution."""

import numpy as np
from numpy.typing import ArrayLike, NDArray

from softfinger.propagation.density import Distribution, convolve_parts
from softfinger.propagation.lattice import PER_SD
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
    """Compute quantiles of the joint angle of one population at each time.

    Parameters
    ----------
    mu, sigma, time, load_time, load_torque, c_p_truncation_sd
        As for `compute_density_array`.
    probability
        (p,), each within 0.0005 … 0.9995.

    Returns
    -------
    (n, p) [rad]

    Examples
    --------
    >>> compute_quantiles_array(
    ...     [-2.4, -3.7, 2.9, 0.02], [0.2, 0.5, 0.7, 0.01], [0.0], [0.0], [0.04], [0.5, 0.975]
    ... ).round(6)
    array([[0.02  , 0.0396]])
    """
    mu, sigma = np.asarray(mu, float), np.asarray(sigma, float)
    time, probability = np.asarray(time, float), np.asarray(probability, float)
    quantile = np.full((time.size, probability.size), np.nan)
    reach = np.full((time.size, 2), FIRST_WINDOW * sigma[Q_INI])
    waiting = np.arange(time.size)
    for _ in range(MOST_DOUBLINGS):
        window = (mu[Q_INI] - reach[waiting, 0], mu[Q_INI] + reach[waiting, 1])
        load = (time[waiting], load_time, load_torque)
        parts = list(convolve_parts(mu, sigma, *load, window, c_p_truncation_sd))
        short = []
        for row, part, low, high in zip(waiting, parts, *window, strict=False):
            below = part.read_probability(np.array([low, high]))
            too_short = [below[0] > probability.min(), below[1] < probability.max()]
            if any(too_short):
                reach[row, too_short] *= 2
                short.append(row)
            else:
                quantile[row] = _invert(part, low, high, probability)
        waiting = np.array(short, int)
        if waiting.size == 0:
            break
    return quantile


def _invert(
    part: Distribution, low: float, high: float, probability: NDArray
) -> NDArray[np.float64]:
    angle = np.arange(low, high + part.sd, part.sd / PER_SD)
    quantile = np.interp(probability, part.read_probability(angle), angle)
    for _ in range(2):  # Newton, from a straight line between points half a sd apart
        density = part.read_density(quantile)
        missing = probability - part.read_probability(quantile)
        quantile = quantile + np.where(density > 0, missing / np.where(density > 0, density, 1), 0)
    return quantile
