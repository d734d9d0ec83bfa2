"""The likelihood of a trial given its own parameters and the noise, from its collapsed matrices.

    log p(y | η) = −½ [Σ_g Σ_jk P_jk (N_jk − 2 ρ_j^g X_jk + ρ_j^g ρ_k^g B_jk) + r₀ᵀ S⁻¹ r₀]
                   −½ [Σ_g n_g log|2π Q_g| + log|2π S|] − J Σ log scale

with N_jk = w_jᵀ N w_k and so on (`collapse`), P = Q_g⁻¹, Q_g the covariance of what the noise gains
over the gap g, and S = Q_∞ (`covariance`). Only the joints present in a trial take part; trials
with the same joints present share a pattern.
"""

from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from softfinger.population.basis import fill_coefficients
from softfinger.population.collapse import Collapse
from softfinger.population.covariance import compute_innovation_covariance_array

PARAMETERS = ("log_k_v", "log_c_v", "log_c_p", "q_ini")


class NoiseWeights(NamedTuple):
    """How the noise weighs the sums of each pattern of present joints.

    `pair` (pattern, node, 3, J, J) multiplies (N, B, X), `first` (pattern, J, J) is S⁻¹; absent
    joints weigh 0. `pair_logdet` (pattern, node) and `first_logdet` (pattern,) are log|2πQ_g|,
    log|2πS|.
    """

    pair: NDArray[np.float64]
    first: NDArray[np.float64]
    pair_logdet: NDArray[np.float64]
    first_logdet: NDArray[np.float64]


def find_patterns_array(
    present: NDArray[np.bool_],
) -> tuple[NDArray[np.bool_], NDArray[np.int64]]:
    """Find the distinct patterns (pattern, joint) of present joints and each trial's (trial,).

    >>> find_patterns_array(np.array([[True, True], [True, False], [True, True]]))
    (array([[ True, False],
           [ True,  True]]), array([1, 0, 1]))
    """
    patterns, index = np.unique(present, axis=0, return_inverse=True)
    return patterns, index.ravel()


def compute_noise_weights_array(
    gap: NDArray[np.float64],
    patterns: NDArray[np.bool_],
    sd: NDArray[np.float64],
    autocorrelation: NDArray[np.float64],
    correlation: NDArray[np.float64],
) -> NoiseWeights:
    """Compute the weights of the collapsed sums.

    Parameters
    ----------
    gap
        (node,) in median frame intervals.
    patterns
        (pattern, joint).
    sd, autocorrelation, correlation
        (joint,) σ [rad], (joint,) ρ, (joint, joint) C of the innovations.
    """
    joints = len(sd)
    pair = np.zeros((len(patterns), len(gap), 3, joints, joints))
    pair_logdet = np.zeros(pair.shape[:2])
    first, first_logdet = np.zeros((len(patterns), joints, joints)), np.zeros(len(patterns))
    for p, here in enumerate(patterns):
        for g, length in enumerate([*gap, np.inf]):
            covariance = compute_innovation_covariance_array(
                length, sd, autocorrelation, correlation
            )
            precision, logdet = _invert_present(covariance, here)
            if g == len(gap):
                first[p], first_logdet[p] = precision, logdet
                continue
            kept = autocorrelation**length
            pair[p, g, 0] = precision
            pair[p, g, 1] = np.outer(kept, kept) * precision
            pair[p, g, 2] = -2 * kept[:, None] * precision
            pair_logdet[p, g] = logdet
    return NoiseWeights(pair, first, pair_logdet, first_logdet)


def _invert_present(covariance: NDArray, here: NDArray[np.bool_]) -> tuple[NDArray, float]:
    both = np.outer(here, here)
    guarded = np.where(both, covariance, np.eye(len(here)))
    logdet = np.linalg.slogdet(guarded)[1] + here.sum() * np.log(2 * np.pi)
    return np.where(both, np.linalg.inv(guarded), 0.0), float(logdet)


def compute_log_likelihood_array(
    collapse: Collapse,
    eta: NDArray[np.float64],
    sd: NDArray[np.float64],
    autocorrelation: NDArray[np.float64],
    correlation: NDArray[np.float64],
) -> NDArray[np.float64]:
    """Compute log p(y_i | η_i, noise) [nats] of each trial.

    Parameters
    ----------
    collapse
        What `collapse_angles` makes.
    eta
        (trial, joint, 4): log k_v, log c_v, log c_p, q_ini.
    sd, autocorrelation, correlation
        (joint,) σ [rad], (joint,) ρ, (joint, joint) C of the innovations.

    Returns
    -------
    (trial,) log density of the used angles [rad]; 0 for a trial without any.
    """
    patterns, index = find_patterns_array(collapse.present)
    weights = compute_noise_weights_array(collapse.gap, patterns, sd, autocorrelation, correlation)
    n, joints = collapse.present.shape
    quadratic, slope = np.empty(n), np.empty((n, joints, 4))
    fill_quadratics(
        np.ascontiguousarray(eta, float), collapse.table.first, collapse.table.step,
        collapse.table.value, collapse.table.slope, collapse.products, collapse.first,
        weights.pair, weights.first, index, quadratic, slope,
        np.zeros_like(weights.pair), np.zeros_like(weights.first),
    )  # fmt: skip
    logdet = (collapse.count * weights.pair_logdet[index]).sum(axis=1)
    logdet += np.where(collapse.present.any(axis=1), weights.first_logdet[index], 0.0)
    return -0.5 * (quadratic + logdet) - collapse.present.sum(axis=1) * collapse.log_scale


@njit(cache=True)
def fill_quadratics(
    eta: NDArray,
    table_first: float,
    table_step: float,
    table_value: NDArray,
    table_slope: NDArray,
    products: NDArray,
    first: NDArray,
    pair: NDArray,
    initial: NDArray,
    pattern: NDArray,
    quadratic: NDArray,
    slope: NDArray,
    sums: NDArray,
    first_sums: NDArray,
) -> None:
    """Write each trial's weighted square (trial,) and its slope by η; add the sums by pattern."""
    trials, joints = eta.shape[0], eta.shape[1]
    size = first.shape[1]
    modes = size - 2 - joints
    weight, bent = np.zeros((joints, size)), np.zeros((joints, modes))
    pull = np.empty((joints, size))
    moved = np.empty((4, joints, size))
    for i in range(trials):
        here = pattern[i]
        for j in range(joints):
            coefficients = weight[j, :modes]
            fill_coefficients(
                eta[i, j, 0] - eta[i, j, 1], table_first, table_step, table_value, table_slope,
                coefficients, bent[j],
            )  # fmt: skip
            compliance = np.exp(-eta[i, j, 0])
            for m in range(modes):
                weight[j, m] *= compliance
                bent[j, m] *= compliance
            weight[j, modes] = np.exp(-eta[i, j, 2])
            weight[j, modes + 1] = eta[i, j, 3]
            weight[j, modes + 2 + j] = -1.0
        quadratic[i] = _start_pull(weight, first[i], initial[here], pull, first_sums[here])
        for g in range(pair.shape[1]):
            quadratic[i] += _add_pairs(
                weight, products[i, g], pair[here, g], moved, pull, sums[here, g]
            )
        for j in range(joints):
            elastic, lagging = 0.0, 0.0
            for m in range(modes):
                elastic += pull[j, m] * weight[j, m]
                lagging += pull[j, m] * bent[j, m]
            slope[i, j, 0] = lagging - elastic
            slope[i, j, 1] = -lagging
            slope[i, j, 2] = -pull[j, modes] * weight[j, modes]
            slope[i, j, 3] = pull[j, modes + 1]


@njit(cache=True)
def _start_pull(
    weight: NDArray, row: NDArray, initial: NDArray, pull: NDArray, sums: NDArray
) -> float:
    """Square of the first residuals; `pull` becomes its slope by the weights."""
    joints = weight.shape[0]
    residual = weight @ row
    total = 0.0
    for j in range(joints):
        force = 0.0
        for k in range(joints):
            force += initial[j, k] * residual[k]
            sums[j, k] += residual[j] * residual[k]
        total += residual[j] * force
        pull[j] = 2.0 * force * row
    return total


@njit(cache=True, fastmath={"reassoc", "contract"})
def _add_pairs(
    weight: NDArray, products: NDArray, pair: NDArray, moved: NDArray, pull: NDArray, sums: NDArray
) -> float:
    """Square of the residuals' gains over a gap; adds slopes to `pull`, parts to `sums`."""
    joints, size = weight.shape
    data = size - joints
    moved[:] = 0.0
    for k in range(joints):
        for c in range(size):
            w = weight[k, c]
            if w == 0.0:
                continue
            for r in range(size):
                moved[0, k, r] += w * products[0, c, r]
                moved[1, k, r] += w * products[1, c, r]
                moved[3, k, r] += w * products[2, c, r]
        for r in range(size):
            lagged = 0.0
            for c in range(data):
                lagged += products[2, r, c] * weight[k, c]
            moved[2, k, r] = lagged - products[2, r, data + k]
    total = 0.0
    for j in range(joints):
        for k in range(joints):
            w0, w1 = 2.0 * pair[0, j, k], 2.0 * pair[1, j, k]
            w2, w3 = pair[2, j, k], pair[2, k, j]
            now, before, cross = 0.0, 0.0, 0.0
            for r in range(size):
                pull[j, r] += (
                    w0 * moved[0, k, r] + w1 * moved[1, k, r]
                    + w2 * moved[2, k, r] + w3 * moved[3, k, r]
                )  # fmt: skip
                now += weight[j, r] * moved[0, k, r]
                before += weight[j, r] * moved[1, k, r]
                cross += weight[j, r] * moved[2, k, r]
            sums[0, j, k] += now
            sums[1, j, k] += before
            sums[2, j, k] += cross
            total += pair[0, j, k] * now + pair[1, j, k] * before + pair[2, j, k] * cross
    return total
