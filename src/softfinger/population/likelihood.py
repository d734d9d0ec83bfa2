"""The likelihood of trials given their own parameters and the noise, from their collapsed matrices.

    log p(y | η) = −½ [Σ_g Σ_jk P_jk (N_jk − 2 ρ_j^g X_jk + ρ_j^g ρ_k^g B_jk) + r₀ᵀ S⁻¹ r₀]
                   −½ [Σ_g n_g log|2π Q_g| + log|2π S|] − J Σ log scale

with N_jk = w_jᵀ N w_k and so on (`collapse`), P = Q_g⁻¹, Q_g the covariance of what the noise gains
over the gap g, and S = Q_∞ (`covariance`). Only the joints present in a trial take part; trials
with the same joints present share a pattern.
"""

import numpy as np
from numba import njit
from numpy.typing import NDArray

from softfinger.population.basis import fill_coefficients
from softfinger.population.collapse import Collapse
from softfinger.population.weights import pull_weights_back, weigh_noise

PARAMETERS = ("log_k_v", "log_c_v", "log_c_p", "q_ini")


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
    noise = (np.asarray(sd, float), np.asarray(autocorrelation, float), correlation)
    weights = weigh_noise(collapse.gap, collapse.patterns, *noise)
    quadratic = np.empty(len(eta))
    fill_squares(
        np.ascontiguousarray(eta, float), *collapse.table, collapse.products, collapse.first,
        weights.pair, weights.precision[:, -1].copy(), collapse.pattern, quadratic,
    )  # fmt: skip
    logdet = (collapse.count * weights.logdet[collapse.pattern]).sum(axis=1)
    return collapse.offset - 0.5 * (quadratic + logdet)


@njit(cache=True, error_model="numpy")
def fill_squares(
    eta: NDArray,
    place: NDArray,
    table_value: NDArray,
    table_slope: NDArray,
    products: NDArray,
    first: NDArray,
    pair: NDArray,
    initial: NDArray,
    pattern: NDArray,
    quadratic: NDArray,
) -> None:
    """Write each trial's weighted square (trial,): `fill_quadratics` without any slope."""
    trials, joints = eta.shape[0], eta.shape[1]
    size = first.shape[1]
    weight, bent = np.zeros((joints, size)), np.empty((joints, size - 2 - joints))
    pull, unused = np.empty((joints, size)), np.zeros((joints, joints))
    for i in range(trials):
        here = pattern[i]
        for j in range(joints):
            _fill_weight(eta[i, j], j, place, table_value, table_slope, weight[j], bent[j])
        quadratic[i] = _start_pull(weight, first[i], initial[here], pull, unused)
        for g in range(pair.shape[1]):
            if products[i, g, 0, size - joints - 1, size - joints - 1] != 0.0:  # such gaps occur
                quadratic[i] += _square_pairs(weight, products[i, g], pair[here, g])


@njit(cache=True, error_model="numpy", fastmath={"reassoc", "contract"})
def _square_pairs(weight: NDArray, products: NDArray, pair: NDArray) -> float:
    """Square of the residuals' gains over a gap."""
    joints, size = weight.shape
    total = 0.0
    for r in range(size):
        for k in range(joints):
            now, before, cross = 0.0, 0.0, 0.0
            for c in range(size):
                w = weight[k, c]
                now += products[0, r, c] * w
                before += products[1, r, c] * w
                cross += products[2, r, c] * w
            for j in range(joints):
                total += weight[j, r] * (
                    pair[0, j, k] * now + pair[1, j, k] * before + pair[2, j, k] * cross
                )
    return total


@njit(cache=True, error_model="numpy")
def sum_log_likelihood(
    eta: NDArray,
    sd: NDArray,
    rho: NDArray,
    correlation: NDArray,
    place: NDArray,
    table_value: NDArray,
    table_slope: NDArray,
    products: NDArray,
    first: NDArray,
    pattern: NDArray,
    patterns: NDArray,
    gap: NDArray,
    total: NDArray,
) -> tuple[float, NDArray, NDArray, NDArray, NDArray]:
    """Sum log p over trials but for constants; also its slopes by η, σ, ρ and C.

    `total` (pattern, gap + 1) counts the pairs of each gap, then the trials, of each pattern.
    """
    weights = weigh_noise(gap, patterns, sd, rho, correlation)
    quadratic, slope = np.empty(eta.shape[0]), np.empty(eta.shape)
    sums = np.zeros(weights.pair.shape)
    initial = weights.precision[:, -1].copy()
    first_sums = np.zeros(initial.shape)
    fill_quadratics(
        eta, place, table_value, table_slope, products, first, weights.pair, initial, pattern,
        quadratic, slope, sums, first_sums,
    )  # fmt: skip
    value = -0.5 * (quadratic.sum() + (total * weights.logdet).sum())
    bars = pull_weights_back(
        gap, sd, rho, correlation, weights.precision, -0.5 * sums, -0.5 * first_sums, -0.5 * total
    )
    return value, -0.5 * slope, bars[0], bars[1], bars[2]


@njit(cache=True, error_model="numpy")
def fill_quadratics(
    eta: NDArray,
    place: NDArray,
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
            _fill_weight(eta[i, j], j, place, table_value, table_slope, weight[j], bent[j])
        quadratic[i] = _start_pull(weight, first[i], initial[here], pull, first_sums[here])
        for g in range(pair.shape[1]):
            if products[i, g, 0, modes + 1, modes + 1] == 0.0:  # no such gap in this trial
                continue
            _move(weight, products[i, g], moved)
            quadratic[i] += _add_pairs(weight, moved, pair[here, g], pull, sums[here, g])
        for j in range(joints):
            elastic, lagging = 0.0, 0.0
            for m in range(modes):
                elastic += pull[j, m] * weight[j, m]
                lagging += pull[j, m] * bent[j, m]
            slope[i, j, 0] = lagging - elastic
            slope[i, j, 1] = -lagging
            slope[i, j, 2] = -pull[j, modes] * weight[j, modes]
            slope[i, j, 3] = pull[j, modes + 1]


@njit(cache=True, error_model="numpy")
def _fill_weight(
    eta: NDArray,
    joint: int,
    place: NDArray,
    table_value: NDArray,
    table_slope: NDArray,
    weight: NDArray,
    bent: NDArray,
) -> None:
    """Write w of a joint's residual and the elastic part's slope by x."""
    modes = bent.size
    rate = eta[0] - eta[1]
    fill_coefficients(rate, place, table_value, table_slope, weight[:modes], bent)
    compliance = np.exp(-eta[0])
    for m in range(modes):
        weight[m] *= compliance
        bent[m] *= compliance
    weight[modes] = np.exp(-eta[2])
    weight[modes + 1] = eta[3]
    weight[modes + 2 + joint] = -1.0


@njit(cache=True, error_model="numpy")
def _start_pull(
    weight: NDArray, row: NDArray, initial: NDArray, pull: NDArray, sums: NDArray
) -> float:
    """Square of the first residuals; `pull` becomes its slope by the weights."""
    joints, size = weight.shape
    residual = np.zeros(joints)
    for j in range(joints):
        for r in range(size):
            residual[j] += weight[j, r] * row[r]
    total = 0.0
    for j in range(joints):
        force = 0.0
        for k in range(joints):
            force += initial[j, k] * residual[k]
            sums[j, k] += residual[j] * residual[k]
        total += residual[j] * force
        for r in range(size):
            pull[j, r] = 2.0 * force * row[r]
    return total


@njit(cache=True, error_model="numpy", fastmath={"reassoc", "contract"})
def _move(weight: NDArray, products: NDArray, moved: NDArray) -> None:
    """Write N w, B w, X w, Xᵀ w of every joint into `moved` (4, joint, D)."""
    joints, size = weight.shape
    for k in range(joints):
        for r in range(size):
            moved[3, k, r] = 0.0
    for r in range(size):
        for k in range(joints):
            now, before, cross = 0.0, 0.0, 0.0
            own = weight[k, r]
            for c in range(size):
                w = weight[k, c]
                now += products[0, r, c] * w
                before += products[1, r, c] * w
                cross += products[2, r, c] * w
                moved[3, k, c] += products[2, r, c] * own
            moved[0, k, r] = now
            moved[1, k, r] = before
            moved[2, k, r] = cross


@njit(cache=True, error_model="numpy", fastmath={"reassoc", "contract"})
def _add_pairs(
    weight: NDArray, moved: NDArray, pair: NDArray, pull: NDArray, sums: NDArray
) -> float:
    """Square of the residuals' gains over a gap; adds slopes to `pull`, parts to `sums`."""
    joints, size = weight.shape
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
