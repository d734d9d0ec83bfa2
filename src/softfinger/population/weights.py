"""How noise weighs the collapsed sums of a trial, and the way back from there to its parameters.

For every pattern of present joints and every gap g, with P the inverse of the covariance Q_g of
what the noise gains (`covariance`), the sums N, B, X of `collapse` get the weights

    P_jk,   ρ_j^g ρ_k^g P_jk,   −2 ρ_j^g P_jk

and the first row gets P of the stationary covariance. Absent joints weigh 0.
"""

from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray


class NoiseWeights(NamedTuple):
    """Weights and log determinants; node runs over the gaps, then the stationary covariance."""

    pair: NDArray[np.float64]  # (pattern, gap, 3, J, J)
    precision: NDArray[np.float64]  # (pattern, gap + 1, J, J): P
    logdet: NDArray[np.float64]  # (pattern, gap + 1): log|Q|


@njit(cache=True, error_model="numpy")
def weigh_noise(
    gap: NDArray, present: NDArray, sd: NDArray, rho: NDArray, correlation: NDArray
) -> NoiseWeights:
    """Compute the weights from gaps (gap,), present (pattern, J), σ, ρ (J,), C (J, J)."""
    patterns, joints = present.shape
    gaps = gap.size
    pair = np.zeros((patterns, gaps, 3, joints, joints))
    precision = np.zeros((patterns, gaps + 1, joints, joints))
    logdet = np.zeros((patterns, gaps + 1))
    root = np.zeros((joints, joints))
    for p in range(patterns):
        here = present[p]
        for g in range(gaps + 1):
            for j in range(joints):
                for k in range(j + 1):
                    root[j, k] = 1.0 if j == k else 0.0
                    if here[j] and here[k]:
                        kept = rho[j] * rho[k]
                        spread = np.sqrt((1.0 - rho[j] ** 2) * (1.0 - rho[k] ** 2))
                        root[j, k] = sd[j] * sd[k] * correlation[j, k] * spread / (1.0 - kept)
                        if g < gaps:
                            root[j, k] *= 1.0 - kept ** gap[g]
            logdet[p, g] = _invert(root, here, precision[p, g])
            if g < gaps:
                for j in range(joints):
                    for k in range(joints):
                        now = precision[p, g, j, k]
                        before = rho[j] ** gap[g]
                        pair[p, g, 0, j, k] = now
                        pair[p, g, 1, j, k] = before * rho[k] ** gap[g] * now
                        pair[p, g, 2, j, k] = -2.0 * before * now
    return NoiseWeights(pair, precision, logdet)


@njit(cache=True, error_model="numpy")
def _invert(root: NDArray, here: NDArray, precision: NDArray) -> float:
    """Write the inverse of the matrix whose lower half is `root`, which becomes its factor."""
    joints = root.shape[0]
    logdet = 0.0
    for j in range(joints):
        for k in range(j + 1):
            value = root[j, k]
            for m in range(k):
                value -= root[j, m] * root[k, m]
            root[j, k] = np.sqrt(value) if j == k else value / root[k, k]
        logdet += 2.0 * np.log(root[j, j])
    column = np.empty(joints)
    for c in range(joints):
        if not here[c]:
            continue
        for j in range(joints):
            value = 1.0 if j == c else 0.0
            for k in range(j):
                value -= root[j, k] * column[k]
            column[j] = value / root[j, j]
        for j in range(joints - 1, -1, -1):
            value = column[j]
            for k in range(j + 1, joints):
                value -= root[k, j] * column[k]
            column[j] = value / root[j, j]
            if here[j]:
                precision[j, c] = column[j]
    return logdet


@njit(cache=True, error_model="numpy")
def pull_weights_back(
    gap: NDArray,
    sd: NDArray,
    rho: NDArray,
    correlation: NDArray,
    precision: NDArray,
    pair_bar: NDArray,
    first_bar: NDArray,
    logdet_bar: NDArray,
) -> tuple[NDArray, NDArray, NDArray]:
    """Slopes by σ, ρ (J,) and C (J, J) from slopes by the weights.

    `pair_bar` (pattern, gap, 3, J, J), `first_bar` (pattern, J, J) by the stationary precision,
    `logdet_bar` (pattern, gap + 1).
    """
    patterns, nodes, joints = precision.shape[:3]
    sd_bar, rho_bar = np.zeros(joints), np.zeros(joints)
    correlation_bar = np.zeros((joints, joints))
    spread = sd * np.sqrt(1.0 - rho**2)
    spread_bar = np.zeros(joints)
    for p in range(patterns):
        for g in range(nodes):
            inverse = precision[p, g]
            inverse_bar = first_bar[p].copy()
            if g < nodes - 1:
                inverse_bar = _unweigh(gap[g], rho, inverse, pair_bar[p, g], rho_bar)
            gained_bar = logdet_bar[p, g] * inverse - inverse @ inverse_bar @ inverse
            for j in range(joints):
                for k in range(joints):
                    kept = rho[j] * rho[k]
                    fresh = 1.0
                    if g < nodes - 1:
                        fresh = 1.0 - kept ** gap[g]
                    unit = spread[j] * spread[k] / (1.0 - kept)
                    level_bar = gained_bar[j, k] * fresh
                    correlation_bar[j, k] += level_bar * unit
                    spread_bar[j] += (
                        (level_bar + gained_bar[k, j] * fresh)
                        * spread[k] * correlation[j, k] / (1.0 - kept)
                    )  # fmt: skip
                    kept_bar = level_bar * unit * correlation[j, k] / (1.0 - kept)
                    if g < nodes - 1:
                        stationary = unit * correlation[j, k]
                        kept_bar -= gained_bar[j, k] * stationary * gap[g] * kept ** (gap[g] - 1.0)
                    rho_bar[j] += kept_bar * rho[k]
                    rho_bar[k] += kept_bar * rho[j]
    for j in range(joints):
        root = np.sqrt(1.0 - rho[j] ** 2)
        sd_bar[j] = spread_bar[j] * root
        rho_bar[j] -= spread_bar[j] * sd[j] * rho[j] / root
    return sd_bar, rho_bar, correlation_bar


@njit(cache=True, error_model="numpy")
def _unweigh(
    gap: float, rho: NDArray, inverse: NDArray, pair_bar: NDArray, rho_bar: NDArray
) -> NDArray:
    """Slope by P of one gap from the slopes by its three weights; adds the slope by ρ directly."""
    joints = rho.size
    bar = np.empty((joints, joints))
    for j in range(joints):
        before = rho[j] ** gap
        before_bar = 0.0
        for k in range(joints):
            other = rho[k] ** gap
            bar[j, k] = (
                pair_bar[0, j, k] + before * other * pair_bar[1, j, k]
                - 2.0 * before * pair_bar[2, j, k]
            )  # fmt: skip
            before_bar += (pair_bar[1, j, k] + pair_bar[1, k, j]) * other * inverse[j, k]
            before_bar -= 2.0 * pair_bar[2, j, k] * inverse[j, k]
        rho_bar[j] += before_bar * gap * rho[j] ** (gap - 1.0)
    return bar
