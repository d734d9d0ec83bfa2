"""A trial's own parameters integrated out: modes and curvatures of the trials of a population.

For trial i with η = (log k_v, log c_v, log c_p, q_ini) of all joints, p = 4 J numbers,

    f(η) = −log p(y | η) + ½ (η − μ)ᵀ Ω⁻¹ (η − μ)

is lowered by damped Gauss–Newton steps; H, the Gauss–Newton curvature of −log p(y | η), and its
slope g give the normal stand-in for the likelihood, exp(−½ ηᵀHη + bᵀη) with b = H η − g.
"""

from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from softfinger.population.basis import fill_coefficients
from softfinger.population.collapse import Collapse
from softfinger.population.weights import NoiseWeights

STEPS = 60
LONGEST_STEP = 1.0  # in any log-parameter, or rad
FLAT = 1e-6  # gain in nats below which a mode is reached


class Modes(NamedTuple):
    """Posterior modes of the trials given population and noise; p = 4 J, joints outermost."""

    eta: NDArray[np.float64]  # (trial, p)
    curvature: NDArray[np.float64]  # (trial, p, p): H
    pull: NDArray[np.float64]  # (trial, p): b
    quadratic: NDArray[np.float64]  # (trial,): the data's part of −2 log p(y | η)


def find_modes(
    collapse: Collapse,
    weights: NoiseWeights,
    mean: NDArray[np.float64],
    precision: NDArray[np.float64],
    start: NDArray[np.float64],
) -> Modes:
    """Find each trial's posterior mode and the normal stand-in for its likelihood there.

    Parameters
    ----------
    collapse, weights
        What `collapse_angles` and `weigh_noise` make.
    mean, precision
        (p,) μ and (p, p) Ω⁻¹ of the population.
    start
        (trial, p) where the search begins.
    """
    trials, size = start.shape
    eta = np.array(start, float)
    curvature, pull = np.empty((trials, size, size)), np.empty((trials, size))
    quadratic = np.empty(trials)
    _search(
        eta, mean, precision, collapse.table.place, collapse.table.value, collapse.table.slope,
        collapse.products, collapse.first, weights.pair, weights.precision[:, -1],
        collapse.pattern, curvature, pull, quadratic,
    )  # fmt: skip
    return Modes(eta, curvature, pull, quadratic)


@njit(cache=True, error_model="numpy")
def _search(
    eta: NDArray,
    mean: NDArray,
    precision: NDArray,
    place: NDArray,
    table_value: NDArray,
    table_slope: NDArray,
    products: NDArray,
    first: NDArray,
    pair: NDArray,
    initial: NDArray,
    pattern: NDArray,
    curvature: NDArray,
    pull: NDArray,
    quadratic: NDArray,
) -> None:
    size = eta.shape[1]
    eye = np.eye(size)
    for i in range(eta.shape[0]):
        here = pattern[i]
        table = (place, table_value, table_slope)
        data = (products[i], first[i], pair[here], initial[here])
        square, slope, bend = _expand(eta[i], table, data)
        away = eta[i] - mean
        level = 0.5 * square + 0.5 * away @ (precision @ away)
        damping = 1e-3
        for _ in range(STEPS):
            lean = bend + precision
            for a in range(size):
                lean[a, a] += damping * lean[a, a]
            step = -np.linalg.solve(lean, slope + precision @ away)
            step *= min(1.0, LONGEST_STEP / np.abs(step).max())
            trial = eta[i] + step
            square_next, slope_next, bend_next = _expand(trial, table, data)
            away_next = trial - mean
            level_next = 0.5 * square_next + 0.5 * away_next @ (precision @ away_next)
            if level_next <= level:
                gain = level - level_next
                eta[i], level, away = trial, level_next, away_next
                square, slope, bend = square_next, slope_next, bend_next
                damping = max(0.2 * damping, 1e-9)
                if gain < FLAT:
                    break
            else:
                damping *= 8.0
                if damping > 1e8:
                    break
        curvature[i] = bend + 1e-12 * eye
        pull[i] = bend @ eta[i] - slope
        quadratic[i] = square


@njit(cache=True, error_model="numpy")
def _expand(eta: NDArray, table: tuple, data: tuple) -> tuple[float, NDArray, NDArray]:
    """Weighted square of a trial's residuals; slope and Gauss–Newton curvature of its half."""
    products, first, pair, initial = data
    joints = initial.shape[0]
    vectors = _stack_vectors(eta, table, first.size, joints)
    count = vectors.shape[0]
    start = vectors @ first
    gram = np.empty((count, count))
    for a in range(count):
        for b in range(count):
            gram[a, b] = initial[a // 5, b // 5] * start[a] * start[b]
    one = first.size - joints - 1
    for g in range(pair.shape[0]):
        if products[g, 0, one, one] == 0.0:  # no such gap in this trial
            continue
        now = vectors @ products[g, 0] @ vectors.T
        before = vectors @ products[g, 1] @ vectors.T
        cross = vectors @ products[g, 2] @ vectors.T
        for a in range(count):
            for b in range(count):
                j, k = a // 5, b // 5
                gram[a, b] += (
                    pair[g, 0, j, k] * now[a, b] + pair[g, 1, j, k] * before[a, b]
                    + 0.5 * (pair[g, 2, j, k] * cross[a, b] + pair[g, 2, k, j] * cross[b, a])
                )  # fmt: skip
    square = 0.0
    slope, bend = np.zeros(4 * joints), np.empty((4 * joints, 4 * joints))
    for j in range(joints):
        for k in range(joints):
            square += gram[5 * j, 5 * k]
            for a in range(4):
                slope[4 * j + a] += gram[5 * j + 1 + a, 5 * k]
                for b in range(4):
                    bend[4 * j + a, 4 * k + b] = gram[5 * j + 1 + a, 5 * k + 1 + b]
    return square, slope, bend


@njit(cache=True, error_model="numpy")
def stack_weights(eta: NDArray, table: tuple, size: int) -> NDArray:
    """Weights w (trial, joint, D) of the residuals of parameters eta (trial, joint, 4)."""
    weights = np.empty((*eta.shape[:2], size))
    for i in range(eta.shape[0]):
        weights[i] = _stack_vectors(eta[i].ravel(), table, size, eta.shape[1])[::5]
    return weights


@njit(cache=True, error_model="numpy")
def _stack_vectors(eta: NDArray, table: tuple, size: int, joints: int) -> NDArray:
    """Per joint the weights w of its residual and their slopes by its four parameters."""
    modes = size - 2 - joints
    vectors = np.zeros((5 * joints, size))
    for j in range(joints):
        w = vectors[5 * j]
        bent = vectors[5 * j + 2, :modes]
        rate = eta[4 * j] - eta[4 * j + 1]
        last = table[1].shape[0] - 1
        fill_coefficients(rate, table[0], table[1], table[2], 0, last, modes, w, bent)
        compliance = np.exp(-eta[4 * j])
        w[:modes] *= compliance
        bent *= -compliance
        vectors[5 * j + 1, :modes] = -bent - w[:modes]
        w[modes] = np.exp(-eta[4 * j + 2])
        vectors[5 * j + 3, modes] = -w[modes]
        w[modes + 1] = eta[4 * j + 3]
        vectors[5 * j + 4, modes + 1] = 1.0
        w[modes + 2 + j] = -1.0
    return vectors
