"""Sobol indices by a Gauss–Hermite tensor rule, compiled.

It is the best of its kind: logarithms of the parameters are normal, so the rule's weight is theirs
and its error falls geometrically with the number of nodes. Like ours it knows that creep and start
add to the elastic part, so that only stiffness and damping of the Kelvin–Voigt element need nodes.
"""

from __future__ import annotations

import numpy as np
from numpy.polynomial.hermite_e import hermegauss
from numpy.typing import NDArray

from softfinger.compiled import compiled


def compute_indices(
    mu: NDArray, sigma: NDArray, times: NDArray, torque: float, nodes: tuple[int, int]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """First-order and total indices (time, 4) of one joint under a step.

    `nodes` are the numbers of nodes for k_v and c_v.
    """
    rules = [hermegauss(number) for number in nodes]
    (z_k, w_k), (z_c, w_c) = rules
    stiffness, damping = np.exp(mu[0] + sigma[0] * z_k), np.exp(mu[1] + sigma[1] * z_c)
    shares = np.empty((times.size, 3))
    _share_elastic(
        stiffness, w_k / w_k.sum(), 1.0 / damping, w_c / w_c.sum(), times, torque, shares
    )
    v_k, v_c, v_kc = shares.T
    inverse = np.exp(-2.0 * mu[2] + sigma[2] ** 2) * np.expm1(sigma[2] ** 2)
    flow, start = (torque * times) ** 2 * inverse, np.full(times.size, sigma[3] ** 2)
    whole = v_k + v_c + v_kc + flow + start
    first = np.stack([v_k, v_c, flow, start], axis=1) / whole[:, None]
    total = first.copy()
    total[:, :2] += (v_kc / whole)[:, None]
    return first, total


@compiled(error_model="numpy")
def _share_elastic(
    stiffness: NDArray,
    weight_k: NDArray,
    fluidity: NDArray,
    weight_c: NDArray,
    times: NDArray,
    torque: float,
    shares: NDArray,
) -> None:
    """Variances of the elastic angle by k_v, by c_v and by both together (time, 3)."""
    angle = np.empty((stiffness.size, fluidity.size))
    by_k, by_c = np.empty(stiffness.size), np.empty(fluidity.size)
    for t in range(times.size):
        by_c[:] = 0.0
        mean = 0.0
        for i in range(stiffness.size):
            full, fall, sum_k = torque / stiffness[i], -stiffness[i] * times[t], 0.0
            for j in range(fluidity.size):
                value = full * (1.0 - np.exp(fall * fluidity[j]))
                angle[i, j] = value
                sum_k += weight_c[j] * value
                by_c[j] += weight_k[i] * value
            by_k[i] = sum_k
            mean += weight_k[i] * sum_k
        v_k = v_c = v_kc = 0.0
        for i in range(stiffness.size):
            v_k += weight_k[i] * (by_k[i] - mean) ** 2
            row = 0.0
            for j in range(fluidity.size):
                row += weight_c[j] * (angle[i, j] - by_k[i] - by_c[j] + mean) ** 2
            v_kc += weight_k[i] * row
        for j in range(fluidity.size):
            v_c += weight_c[j] * (by_c[j] - mean) ** 2
        shares[t, 0], shares[t, 1], shares[t, 2] = v_k, v_c, v_kc
