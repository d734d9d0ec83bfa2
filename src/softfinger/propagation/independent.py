"""Exact shares of the variance, of independent parameters.

The angle is a sum of three independent parts, so that its variance splits exactly:

    V = V_k + V_c + V_kc  (elastic part)  +  I² Var[1/c_p]  +  Var[q_ini]

and the only interaction is that of k_v with c_v. V_k, V_c and V_kc come from the analysis of
variance of e(t; k_v/c_v)/k_v on a lattice in (log k_v, log c_v) whose steps are multiples of each
other, so that few distinct rates occur. Each part is a weighted sum of squares: no index can be
negative, and they sum to 1.

ASSUME: k_v, c_v, c_p and q_ini are independent of each other within a population.

References
----------
Homma, Saltelli (1996), Reliability Engineering and System Safety 52, 1.
"""

import numpy as np
from numpy.typing import ArrayLike, NDArray

from softfinger.compiled import compiled
from softfinger.mechanics.load import integrate_load_array
from softfinger.mechanics.three_element import compute_elastic_basis_array
from softfinger.progress import track_progress
from softfinger.propagation.moments import C_P, C_V, K_V, Q_INI, compute_inverse_moments
from softfinger.propagation.quadrature import REACH, compute_log_step, compute_normal_weights
from softfinger.propagation.subsets import SUBSETS, Subset


def share_variance_array(
    mu: ArrayLike,
    sigma: ArrayLike,
    time: ArrayLike,
    load_time: ArrayLike,
    load_torque: ArrayLike,
    c_p_truncation_sd: float | None = None,
) -> dict[Subset, NDArray[np.float64]]:
    """Compute the shares of variance that sets explain.

    Arguments as for `compute_moments_array`. Errors are of the order 1e-12 of the variance.

    Returns
    -------
    dict
        Every set of parameters → (…, n).

    Examples
    --------
    Before the load has acted, only the initial angle varies:

    >>> share = share_variance_array(
    ...     [-2.4, -3.7, 2.9, 0.02], [0.2, 0.5, 0.7, 0.01], [0.0], [0.0], [0.04])
    >>> share[0, 1, 2], share[3,]
    (array([0.]), array([1.]))
    """
    mu, sigma, time = (np.asarray(a, float) for a in (mu, sigma, time))
    shape = (*mu.shape[:-1], time.size)
    mu, sigma = mu.reshape(-1, 4), sigma.reshape(-1, 4)
    part = np.full((len(mu), time.size, 5), np.nan)
    impulse = integrate_load_array(time, load_time, load_torque)
    known = np.flatnonzero(np.isfinite(mu).all(axis=1) & (sigma > 0).all(axis=1))
    for row in track_progress(known, "splitting the spread"):
        elastic = split_elastic_variance_array(mu[row], sigma[row], time, load_time, load_torque)
        _, log_inverse = compute_inverse_moments(mu[row, C_P], sigma[row, C_P], c_p_truncation_sd)
        part[row] = _share_parts(elastic, log_inverse, impulse, sigma[row, Q_INI])
    shares = (part @ _PARTS).reshape(*shape, len(SUBSETS))
    return {subset: shares[..., k] for k, subset in enumerate(SUBSETS)}


_PARTS = np.array(
    [
        [p in subset for p in (K_V, C_V, C_P, Q_INI)] + [{K_V, C_V} <= set(subset)]
        for subset in SUBSETS
    ],
    float,
).T  # which of the five parts of the variance a set explains


def split_elastic_variance_array(
    mu: NDArray, sigma: NDArray, time: ArrayLike, load_time: ArrayLike, load_torque: ArrayLike
) -> NDArray[np.float64]:
    """Split the variance of the elastic part.

    It gives V_k, V_c, V_kc: (3, n) [rad²], each ≥ 0.

    `mu` and `sigma` are (4,), or longer, in the order of the parameters.
    """
    step = compute_log_step(sigma[: C_V + 1])
    coarser = int(np.argmax(step))
    step[coarser] = step.min() * np.floor(step[coarser] / step.min())
    # 1/k_v² moves the weight of k_v by two σ² down
    below = [
        int((REACH + 2 * sigma[K_V]) * sigma[K_V] / step[K_V]) + 1,
        int(REACH * sigma[C_V] / step[C_V]) + 1,
    ]
    above = [int(REACH * sigma[p] / step[p]) + 1 for p in (K_V, C_V)]
    log_k, log_c = (mu[p] + step[p] * np.arange(-below[p], above[p] + 1) for p in (K_V, C_V))
    stride = np.rint(step / step.min()).astype(int)
    place = stride[K_V] * np.arange(log_k.size)[:, None] - stride[C_V] * np.arange(log_c.size)
    used, row = np.unique(place, return_inverse=True)
    rate = np.exp(log_k[0] - log_c[0] + step.min() * used)
    table = compute_elastic_basis_array(rate, time, load_time, load_torque)[0]
    return _analyse_variance(
        table,
        row.reshape(place.shape),
        np.exp(-log_k),
        compute_normal_weights(log_k, mu[K_V], sigma[K_V]),
        compute_normal_weights(log_c, mu[C_V], sigma[C_V]),
    )


@compiled
def _analyse_variance(
    table: NDArray, row: NDArray, compliance: NDArray, weight_k: NDArray, weight_c: NDArray
) -> NDArray:
    n = table.shape[1]
    given_k, given_c = np.zeros((weight_k.size, n)), np.zeros((weight_c.size, n))
    for i in range(weight_k.size):
        for j in range(weight_c.size):
            a, b, angle = weight_c[j] * compliance[i], weight_k[i] * compliance[i], table[row[i, j]]
            for t in range(n):
                given_k[i, t] += a * angle[t]
                given_c[j, t] += b * angle[t]
    mean = np.zeros(n)
    for i in range(weight_k.size):
        mean += weight_k[i] * given_k[i]
    split = np.zeros((3, n))
    for i in range(weight_k.size):
        split[0] += weight_k[i] * (given_k[i] - mean) ** 2
        for j in range(weight_c.size):
            w, angle = weight_k[i] * weight_c[j], table[row[i, j]]
            for t in range(n):
                rest = compliance[i] * angle[t] - given_k[i, t] - given_c[j, t] + mean[t]
                split[2, t] += w * rest * rest
    for j in range(weight_c.size):
        split[1] += weight_c[j] * (given_c[j] - mean) ** 2
    return split


def _share_parts(
    elastic: NDArray, log_inverse: float, impulse: NDArray, sd_q_ini: float
) -> NDArray:
    # in logs, because a hardly identified σ makes Var[1/c_p] overflow long before it is wrong
    with np.errstate(divide="ignore"):
        flow = 2 * np.log(np.abs(impulse)) + log_inverse
        parts = [
            np.log(elastic[0]),
            np.log(elastic[1]),
            flow,
            np.full(impulse.size, 2 * np.log(sd_q_ini)),
            np.log(elastic[2]),
        ]
    log_part = np.stack(parts, axis=-1)
    part = np.exp(log_part - log_part.max(axis=-1, keepdims=True))
    return part / part.sum(axis=-1, keepdims=True)
