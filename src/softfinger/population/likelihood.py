"""The likelihood of trials given their own parameters and the noise, from their collapsed matrices.

    log p(y | η) = −½ [Σ_g Σ_jk P_jk (N_jk − 2 ρ_j^g X_jk + ρ_j^g ρ_k^g B_jk) + r₀ᵀ S⁻¹ r₀]
                   −½ [Σ_g n_g log|2π Q_g| + log|2π S|] − J Σ log scale

with N_jk = w_jᵀ N w_k and so on (`collapse`, `windows`), P = Q_g⁻¹, Q_g the covariance of what the
noise gains over the gap g, and S = Q_∞ (`covariance`). Only the joints present in a trial take
part; trials with the same joints present share a pattern.
"""

import numpy as np
from numba import njit
from numpy.typing import NDArray

from softfinger.population.basis import fill_coefficients
from softfinger.population.weights import pull_weights_back, weigh_noise
from softfinger.population.windows import LocalCollapse, Windows

PARAMETERS = ("log_k_v", "log_c_v", "log_c_p", "q_ini")


def compute_log_likelihood_array(
    collapse: LocalCollapse,
    eta: NDArray[np.float64],
    sd: NDArray[np.float64],
    autocorrelation: NDArray[np.float64],
    correlation: NDArray[np.float64],
) -> NDArray[np.float64]:
    """Compute log p(y_i | η_i, noise) [nats] of each trial.

    Parameters
    ----------
    collapse
        What `localise_collapse` makes.
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
        np.ascontiguousarray(eta, float), collapse.windows, collapse.window, collapse.products,
        collapse.first, weights.pair, weights.precision[:, -1].copy(), collapse.pattern, quadratic,
    )  # fmt: skip
    logdet = (collapse.count * weights.logdet[collapse.pattern]).sum(axis=1)
    return collapse.offset - 0.5 * (quadratic + logdet)


@njit(cache=True, error_model="numpy")
def fill_squares(
    eta: NDArray,
    windows: Windows,
    window: NDArray,
    products: NDArray,
    first: NDArray,
    pair: NDArray,
    initial: NDArray,
    pattern: NDArray,
    quadratic: NDArray,
) -> None:
    """Write each trial's weighted square (trial,): `fill_quadratics` without any slope."""
    joints, most = eta.shape[1], windows.value.shape[1]
    weight, bent = np.zeros((joints, most + 3)), np.empty((joints, most))
    pull, unused = np.empty(weight.shape), np.zeros((joints, joints))
    begin = np.empty(joints + 1, np.int64)
    for i in range(eta.shape[0]):
        here = pattern[i]
        _fill_weights(eta[i], windows, window[i], weight, bent, begin)
        one = begin[1] - 2
        quadratic[i] = _start_pull(weight, begin, first[i], initial[here], pull, unused)
        for g in range(pair.shape[1]):
            if products[g, i, 0, one, one] != 0.0:  # such gaps occur
                quadratic[i] += _square_pairs(weight, begin, products[g, i], pair[here, g])


@njit(cache=True, error_model="numpy")
def _square_pairs(weight: NDArray, begin: NDArray, products: NDArray, pair: NDArray) -> float:
    """Square of the residuals' gains over a gap."""
    joints = weight.shape[0]
    total = 0.0
    for j in range(joints):
        for k in range(joints):
            for r in range(begin[j + 1] - begin[j]):
                now, before, cross = 0.0, 0.0, 0.0
                for c in range(begin[k + 1] - begin[k]):
                    w = weight[k, c]
                    now += products[0, begin[j] + r, begin[k] + c] * w
                    before += products[1, begin[j] + r, begin[k] + c] * w
                    cross += products[2, begin[j] + r, begin[k] + c] * w
                total += weight[j, r] * (
                    pair[0, j, k] * now + pair[1, j, k] * before + pair[2, j, k] * cross
                )
    return total


@njit(cache=True, error_model="numpy")
def fill_trial_sums(
    eta: NDArray,
    windows: Windows,
    window: NDArray,
    products: NDArray,
    first: NDArray,
    sums: NDArray,
    first_sums: NDArray,
) -> None:
    """Write the sums N, B, X of each trial (trial, gap, 3, J, J) and its r₀r₀ᵀ (trial, J, J).

    Weighed by `weigh_noise` they give the trial's weighted square under any noise.
    """
    joints, most = eta.shape[1], windows.value.shape[1]
    weight, bent = np.zeros((joints, most + 3)), np.empty((joints, most))
    pull, none = np.empty(weight.shape), np.zeros((joints, joints))
    begin = np.empty(joints + 1, np.int64)
    for i in range(eta.shape[0]):
        _fill_weights(eta[i], windows, window[i], weight, bent, begin)
        first_sums[i], sums[i] = 0.0, 0.0
        _start_pull(weight, begin, first[i], none, pull, first_sums[i])
        one = begin[1] - 2
        for g in range(products.shape[0]):
            if products[g, i, 0, one, one] != 0.0:  # such gaps occur
                _sum_pairs(weight, begin, products[g, i], sums[i, g])


@njit(cache=True, error_model="numpy")
def _sum_pairs(weight: NDArray, begin: NDArray, products: NDArray, sums: NDArray) -> None:
    """Add w_jᵀ N w_k, w_jᵀ B w_k and w_jᵀ X w_k over a gap to (3, J, J)."""
    joints = weight.shape[0]
    for part in range(3):
        for j in range(joints):
            for r in range(begin[j + 1] - begin[j]):
                row = products[part, begin[j] + r]
                for k in range(joints):
                    total = 0.0
                    for c in range(begin[k + 1] - begin[k]):
                        total += row[begin[k] + c] * weight[k, c]
                    sums[part, j, k] += weight[j, r] * total


@njit(cache=True, error_model="numpy", inline="always")
def sum_log_likelihood(
    eta: NDArray,
    sd: NDArray,
    rho: NDArray,
    correlation: NDArray,
    windows: Windows,
    window: NDArray,
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
        eta, windows, window, products, first, weights.pair, initial, pattern,
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
    windows: Windows,
    window: NDArray,
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
    joints, most = eta.shape[1], windows.value.shape[1]
    weight, bent = np.zeros((joints, most + 3)), np.zeros((joints, most))
    pull, moved = np.empty(weight.shape), np.empty((joints, 3, first.shape[1]))
    begin = np.empty(joints + 1, np.int64)
    for i in range(eta.shape[0]):
        here = pattern[i]
        _fill_weights(eta[i], windows, window[i], weight, bent, begin)
        one = begin[1] - 2
        quadratic[i] = _start_pull(weight, begin, first[i], initial[here], pull, first_sums[here])
        for g in range(pair.shape[1]):
            if products[g, i, 0, one, one] == 0.0:  # no such gap in this trial
                continue
            _move(weight, begin, products[g, i], pair[here, g, 2], moved, pull)
            quadratic[i] += _add_pairs(weight, begin, moved, pair[here, g], pull, sums[here, g])
        for j in range(joints):
            modes = begin[j + 1] - begin[j] - 3
            elastic, lagging = 0.0, 0.0
            for m in range(modes):
                elastic += pull[j, m] * weight[j, m]
                lagging += pull[j, m] * bent[j, m]
            slope[i, j, 0] = lagging - elastic
            slope[i, j, 1] = -lagging
            slope[i, j, 2] = -pull[j, modes] * weight[j, modes]
            slope[i, j, 3] = pull[j, modes + 1]


@njit(cache=True, error_model="numpy")
def _fill_weights(
    eta: NDArray,
    windows: Windows,
    window: NDArray,
    weight: NDArray,
    bent: NDArray,
    begin: NDArray,
) -> None:
    """Write w of every joint's residual, the elastic part's slope by x, and where blocks begin."""
    begin[0] = 0
    for j in range(eta.shape[0]):
        w = window[j]
        modes = windows.modes[w]
        fill_coefficients(
            eta[j, 0] - eta[j, 1], windows.place[w], windows.value, windows.slope,
            windows.begin[w], windows.begin[w + 1] - 1, modes, weight[j], bent[j],
        )  # fmt: skip
        compliance = np.exp(-eta[j, 0])
        for m in range(modes):
            weight[j, m] *= compliance
            bent[j, m] *= compliance
        weight[j, modes] = np.exp(-eta[j, 2])
        weight[j, modes + 1] = eta[j, 3]
        weight[j, modes + 2] = -1.0
        begin[j + 1] = begin[j] + modes + 3


@njit(cache=True, error_model="numpy")
def _start_pull(
    weight: NDArray, begin: NDArray, row: NDArray, initial: NDArray, pull: NDArray, sums: NDArray
) -> float:
    """Square of the first residuals; `pull` becomes its slope by the weights."""
    joints = weight.shape[0]
    residual = np.zeros(joints)
    for j in range(joints):
        for r in range(begin[j + 1] - begin[j]):
            residual[j] += weight[j, r] * row[begin[j] + r]
    total = 0.0
    for j in range(joints):
        force = 0.0
        for k in range(joints):
            force += initial[j, k] * residual[k]
            sums[j, k] += residual[j] * residual[k]
        total += residual[j] * force
        for r in range(begin[j + 1] - begin[j]):
            pull[j, r] = 2.0 * force * row[begin[j] + r]
    return total


@njit(cache=True, error_model="numpy")
def _move(
    weight: NDArray,
    begin: NDArray,
    products: NDArray,
    crossing: NDArray,
    moved: NDArray,
    pull: NDArray,
) -> None:
    """Write N w, B w, Xᵀ w of every joint into `moved` (joint, 3, D); every row is read once.

    `pull` gains Σ_k −2 ρ_j^g P_jk X w_k, whose weights `crossing` (joint, joint) are.
    """
    joints = weight.shape[0]
    size = begin[joints]
    mixed = np.empty(size)
    for j in range(joints):
        for k in range(joints):
            for c in range(begin[k], begin[k + 1]):
                mixed[c] = crossing[j, k] * weight[k, c - begin[k]]
        now, before, cross = moved[j, 0], moved[j, 1], moved[j, 2]
        for c in range(size):
            now[c], before[c], cross[c] = 0.0, 0.0, 0.0
        for r in range(begin[j], begin[j + 1]):
            w, row = weight[j, r - begin[j]], products[0, r]
            for c in range(size):
                now[c] += w * row[c]
            row = products[1, r]
            for c in range(size):
                before[c] += w * row[c]
            row, total = products[2, r], 0.0
            for c in range(size):
                cross[c] += w * row[c]
                total += mixed[c] * row[c]
            pull[j, r - begin[j]] += total


@njit(cache=True, error_model="numpy")
def _add_pairs(
    weight: NDArray, begin: NDArray, moved: NDArray, pair: NDArray, pull: NDArray, sums: NDArray
) -> float:
    """Square of the residuals' gains over a gap; adds slopes to `pull`, parts to `sums`."""
    joints = weight.shape[0]
    total = 0.0
    for j in range(joints):
        for k in range(joints):
            w0, w1, w2 = 2.0 * pair[0, k, j], 2.0 * pair[1, k, j], pair[2, k, j]
            now, before, cross = 0.0, 0.0, 0.0
            for r in range(begin[j + 1] - begin[j]):
                place = begin[j] + r
                n, b, x = moved[k, 0, place], moved[k, 1, place], moved[k, 2, place]
                pull[j, r] += w0 * n + w1 * b + w2 * x
                now += weight[j, r] * n
                before += weight[j, r] * b
                cross += weight[j, r] * x
            sums[0, k, j] += now
            sums[1, k, j] += before
            sums[2, k, j] += cross
            total += pair[0, k, j] * now + pair[1, k, j] * before + pair[2, k, j] * cross
    return total
