"""Mean and variance of the joint angle.

    q(t) = e(t; k_v/c_v)/k_v + I(t)/c_p + q_ini,   I = ∫u dt

Weighing a log-normal k_v by k_v^(−p) only shifts its log-mean, by −p σ²; so with x = log(k_v/c_v)

    E[(e/k_v)^p] = exp(−p μ_k + p² σ_k²/2) E[e(x)^p],   x ~ N(μ_k − μ_c − p σ_k², σ_k² + σ_c²),

one dimension, with one table e(x, t) for all populations. The moments of 1/c_p are closed forms.

ASSUME: k_v, c_v, c_p and q_ini are independent of each other within a population.
"""

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.special import ndtr

from softfinger.mechanics.load import integrate_load_array
from softfinger.mechanics.three_element import compute_elastic_basis_array
from softfinger.propagation.quadrature import REACH, compute_log_step, compute_normal_weights

K_V, C_V, C_P, Q_INI = range(4)  # places on the parameter axis


def compute_moments_array(
    mu: ArrayLike,
    sigma: ArrayLike,
    time: ArrayLike,
    load_time: ArrayLike,
    load_torque: ArrayLike,
    c_p_truncation_sd: float | None = None,
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Compute mean and variance of the joint angle.

    Parameters
    ----------
    mu, sigma
        (…, 4) in the order k_v, c_v, c_p (of their logs), q_ini [rad]; rows with NaN give NaN.
    time
        (n,) [s].
    load_time, load_torque
        (knot,) [s], [N m].
    c_p_truncation_sd
        Keep |log c_p − μ| ≤ this many σ only; None keeps all.

    Returns
    -------
    mean, variance : (…, n) [rad], [rad²]; infinite where a moment exceeds the floating range.

    Examples
    --------
    The paper's joint 3 after 30 s of 0.04 N m: its table cannot make the paper's band.

    >>> mean, variance = compute_moments_array(
    ...     [-1.88, -3.8777, 1.3114, 0.02], [0.3957, 0.8223, 3.2316, 0.01], [30.0], [0.0], [0.04])
    >>> mean.round(1), np.sqrt(variance).round(-2)
    (array([60.2]), array([11100.]))
    """
    mu, sigma, time = (np.asarray(a, float) for a in (mu, sigma, time))
    shape = (*mu.shape[:-1], time.size)
    mu, sigma = mu.reshape(-1, 4), sigma.reshape(-1, 4)
    known = np.isfinite(mu).all(axis=1) & (sigma > 0).all(axis=1)
    mean, variance = np.full((2, len(mu), time.size), np.nan)
    if known.any():
        m, s = mu[known], sigma[known]
        elastic_mean, elastic_variance = _compute_elastic(m, s, time, load_time, load_torque)
        impulse = integrate_load_array(time, load_time, load_torque)
        inverse, log_variance = compute_inverse_moments(m[:, C_P], s[:, C_P], c_p_truncation_sd)
        with np.errstate(over="ignore"):
            flow_variance = _scale_variance(impulse, log_variance)
        mean[known] = elastic_mean + inverse[:, None] * impulse + m[:, Q_INI, None]
        variance[known] = elastic_variance + flow_variance + s[:, Q_INI, None] ** 2
    return mean.reshape(shape), variance.reshape(shape)


def compute_inverse_moments(
    mu: ArrayLike, sigma: ArrayLike, truncation_sd: float | None = None
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Compute mean and log variance of 1/c.

    log c ~ N(μ, σ²), whole or truncated.

    E[c^−p] = exp(−p μ + p² σ²/2) · (Φ(z + pσ) − Φ(−z + pσ)) / (Φ(z) − Φ(−z)) for |log c − μ| ≤ z σ.

    Examples
    --------
    >>> mean, log_variance = compute_inverse_moments(1.3114, 3.2316)
    >>> mean.round(1), np.exp(log_variance / 2).round(-2)
    (np.float64(49.9), np.float64(9200.0))
    """
    mu, sigma = np.asarray(mu, float), np.asarray(sigma, float)
    kept = [0.0, 0.0]  # logs of the two truncation factors
    if truncation_sd is not None:
        z = truncation_sd
        share = ndtr(z) - ndtr(-z)
        kept = [np.log((ndtr(z + p * sigma) - ndtr(-z + p * sigma)) / share) for p in (1, 2)]
    log_mean = -mu + sigma**2 / 2 + kept[0]
    log_ratio = sigma**2 + kept[1] - 2 * kept[0]  # log of E[c^−2]/E[1/c]²
    with np.errstate(over="ignore"):
        return np.exp(log_mean), 2 * log_mean + log_ratio + np.log(-np.expm1(-log_ratio))


def _compute_elastic(
    mu: NDArray, sigma: NDArray, time: NDArray, load_time: ArrayLike, load_torque: ArrayLike
) -> tuple[NDArray, NDArray]:
    spread = np.hypot(sigma[:, K_V], sigma[:, C_V])
    centre = [mu[:, K_V] - mu[:, C_V] - p * sigma[:, K_V] ** 2 for p in (1, 2)]
    step = compute_log_step(spread).min()
    lowest = (centre[1] - REACH * spread).min()
    highest = (centre[0] + REACH * spread).max()
    lattice = lowest + step * np.arange(int((highest - lowest) / step) + 2)
    table = compute_elastic_basis_array(np.exp(lattice), time, load_time, load_torque)[0]
    moment = [
        np.exp(-p * mu[:, K_V] + (p * sigma[:, K_V]) ** 2 / 2)[:, None]
        * (compute_normal_weights(lattice, centre[p - 1], spread) @ table**p)
        for p in (1, 2)
    ]
    return moment[0], np.maximum(moment[1] - moment[0] ** 2, 0.0)


def _scale_variance(impulse: NDArray, log_variance: NDArray) -> NDArray:
    # 0 · ∞ must stay 0: no impulse, no flow
    with np.errstate(divide="ignore"):
        log_square = 2 * np.log(np.abs(impulse))
    return np.exp(log_variance[:, None] + log_square)
