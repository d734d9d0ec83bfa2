"""A linear mixed-effects model, solved from Gram matrices.

Trial i, whitened to unit noise, with its own parameters η_i and shared parameters φ:

    z_i = A_i η_i + B_i φ + ε_i,   η_i ~ N(μ, Ω),   ε_i ~ N(0, 1),   (μ, φ) ~ N(m, P⁻¹)

needs only G_i = CᵀC of C = [A | B | z]. η_i, μ and φ are integrated exactly; Ω, block-diagonal, is
the maximum of its restricted likelihood and an inverse-Wishart prior of ν trials of covariance S
(density taken over log Ω, so that EM is Ω = (ν S + Σ E[b bᵀ]) / (ν + n)), its sds at most `WIDEST`
times those of S: a trial that shows nothing of a parameter would send both to infinity.

References
----------
Laird, Ware (1982), Biometrics 38, 963. Varadhan, Roland (2008), Scand. J. Stat. 35, 335 (SQUAREM).
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from softfinger.compiled import compiled
from softfinger.inference.omega import pack_omega, unpack_omega

LOG_TWO_PI = float(np.log(2.0 * np.pi))
ROUNDING = 4.0 * np.finfo(float).eps
WIDEST = 20.0
FARTHEST = 3.0  # that an extrapolation takes the logarithm of an sd: far beyond, Ω is singular


class Prior(NamedTuple):
    """Priors of a mixed-effects model.

    It has d own and p shared parameters.

    Attributes
    ----------
    mean, precision
        (d + p,) of μ and φ, independent.
    spread
        (d,) typical sd of a parameter between trials: S is its square, diagonal.
    weight
        ν, what the typical sd counts in trials.
    block
        Own parameters come in blocks of this many (a joint's four) that may be correlated.
    """

    mean: NDArray[np.float64]
    precision: NDArray[np.float64]
    spread: NDArray[np.float64]
    weight: float
    block: int


class LinearFit(NamedTuple):
    """Result of a linear mixed-effects model.

    Attributes
    ----------
    shared, shared_covariance
        (d + p,), (d + p, d + p): μ and φ.
    omega
        (d, d).
    own, own_covariance
        (trial, d), (trial, d, d): η_i given the data; covariance given μ and φ.
    log_evidence
        log p(z | Ω) + log p(Ω) [nats], without the constants of the noise and of Ω's prior.
    """

    shared: NDArray[np.float64]
    shared_covariance: NDArray[np.float64]
    omega: NDArray[np.float64]
    own: NDArray[np.float64]
    own_covariance: NDArray[np.float64]
    log_evidence: float


def fit_linear(
    gram: NDArray[np.float64],
    prior: Prior,
    omega: NDArray[np.float64],
    *,
    rounds: int = 30,
    tolerance: float = 1e-3,
) -> LinearFit:
    """Fit the linear mixed-effects model.

    The method is accelerated EM over Ω.

    Parameters
    ----------
    gram
        (trial, d + p + 1, d + p + 1) Gram matrices of [A | B | z].
    omega
        (d, d) to start from.
    rounds
        Most rounds of two EM steps and one extrapolation.
    tolerance
        Gain of the log evidence in a round [nats] at which to stop.

    Examples
    --------
    One trial of one number z = 2 with unit noise and η ~ N(0, Ω = 1): half of it is η's.

    >>> prior = Prior(np.zeros(1), np.full(1, 1e12), np.ones(1), 1e12, 1)
    >>> fit = fit_linear(np.array([[[1.0, 2.0], [2.0, 4.0]]]), prior, np.eye(1))
    >>> fit.own.round(6)
    array([[1.]])
    """
    gram = np.ascontiguousarray(gram, float)
    omega, _ = climb_omega(gram, prior, np.ascontiguousarray(omega, float), rounds, tolerance)
    return LinearFit(*solve_gram(gram, prior, omega)[:-1])


def hold_omega(gram: NDArray[np.float64], prior: Prior, omega: NDArray[np.float64]) -> LinearFit:
    """Solve the linear mixed-effects model for a given Ω."""
    solved = solve_gram(
        np.ascontiguousarray(gram, float), prior, np.ascontiguousarray(omega, float)
    )
    return LinearFit(*solved[:-1])


@compiled
def solve_gram(
    gram: NDArray, prior: Prior, omega: NDArray
) -> tuple[NDArray, NDArray, NDArray, NDArray, NDArray, float, NDArray]:
    """Solution for a given Ω, and EM's next Ω."""
    mean, precision, spread, weight, block = prior
    trials, size = gram.shape[0], gram.shape[1]
    d, m = omega.shape[0], size - 1
    inverse = np.linalg.inv(omega)
    kept = np.empty((trials, d, d))
    normal = np.diag(np.append(precision, 0.0))
    normal[:m, m] = precision * mean
    normal[m, m] = np.sum(precision * mean**2)
    log_omega = np.linalg.slogdet(omega)[1]
    scratch = np.empty((d, d + 1)), np.empty((d, d)), np.empty((d, size)), np.empty((size, size))
    logdet = 0.0
    for i in range(trials):
        logdet += log_omega + _integrate_own(gram[i], inverse, scratch, kept[i], normal)
    for k in range(m):  # trials add to what the prior knows; rounding may take it away
        normal[k, k] = max(normal[k, k], precision[k])
    hessian = np.ascontiguousarray(normal[:m, :m])
    covariance = invert_scaled(hessian)
    shared = covariance @ np.ascontiguousarray(normal[:m, m])
    square = normal[m, m] - shared @ np.ascontiguousarray(normal[:m, m])
    evidence = -0.5 * (square + logdet + np.linalg.slogdet(hessian)[1])
    evidence += 0.5 * np.sum(np.log(precision))
    evidence -= 0.5 * weight * (log_omega + np.sum(np.diag(inverse) * spread**2))
    own, moment = _gather_own(gram, kept, shared, covariance)
    for a in range(d):
        moment[a, a] += weight * spread[a] ** 2
        for b in range(d):
            if a // block != b // block:
                moment[a, b] = 0.0
    moment = (moment + moment.T) / (2.0 * (weight + trials))
    shrink = np.minimum(1.0, WIDEST * spread / np.sqrt(np.diag(moment)))
    return shared, covariance, omega, own, kept, evidence, moment * np.outer(shrink, shrink)


@compiled
def _gather_own(
    gram: NDArray, kept: NDArray, shared: NDArray, covariance: NDArray
) -> tuple[NDArray, NDArray]:
    """Own parameters, and Σ E[b bᵀ] of their distances b from μ.

    (trial, d) and (d, d).
    """
    trials, d, m = kept.shape[0], kept.shape[1], shared.size
    own, moment, shift = np.empty((trials, d)), np.zeros((d, d)), np.empty(d)
    share, wide = np.empty((d, m + 1)), np.empty((d, m + 1))
    padded, spread = np.zeros((m + 1, m + 1)), np.empty((d, d))
    padded[:m, :m] = covariance
    for i in range(trials):
        np.dot(kept[i], gram[i, :d], share)
        np.dot(share, padded, wide)
        np.dot(wide, share.T, spread)
        for a in range(d):
            shift[a] = share[a, m]
            for k in range(m):
                shift[a] -= share[a, k] * shared[k]
            own[i, a] = shared[a] + shift[a]
        for a in range(d):
            for b in range(d):
                moment[a, b] += shift[a] * shift[b] + kept[i, a, b] + spread[a, b]
    return own, moment


@compiled(inline="always")
def _integrate_own(
    gram: NDArray,
    inverse: NDArray,
    scratch: tuple[NDArray, NDArray, NDArray, NDArray],
    kept: NDArray,
    normal: NDArray,
) -> float:
    """Add a trial's part to the normal matrix.

    It is G − G_η K G_ηᵀ with K = (P + G_ηη)⁻¹ = WᵀW; writes K; returns log|P + G_ηη|.

    In the form P − P K P, G_φη K P large numbers do not cancel, however much the trial shows. Each
    row of P + G_ηη is factorised in its own unit, and its diagonal enlarged by what rounding may
    have taken: K alone would lose the digits that it needs where own parameters look alike.
    Works in `scratch`: the factor beside each row's unit (d, d + 1), W (d, d), W [P | G_ηφ]
    (d, d + p + 1) and its square.
    """
    factor, white, whole, product = scratch
    d, size = whole.shape
    logdet = 0.0
    for a in range(d):
        unit = math.sqrt(inverse[a, a] + gram[a, a])
        factor[a, d] = unit
        for b in range(d):
            white[a, b] = 0.0
            whole[a, b] = inverse[a, b] / unit
        white[a, a] = 1.0 / unit
        for b in range(d, size):
            whole[a, b] = gram[a, b] / unit
    for a in range(d):
        for b in range(a + 1):
            rest = (inverse[a, b] + gram[a, b]) / (factor[a, d] * factor[b, d])
            for k in range(b):
                rest -= factor[a, k] * factor[b, k]
            factor[a, b] = rest / factor[b, b] if b < a else math.sqrt(max(rest, 0.0) + ROUNDING)
        for b in range(a):
            for c in range(d):
                white[a, c] -= factor[a, b] * white[b, c]
            for c in range(size):
                whole[a, c] -= factor[a, b] * whole[b, c]
        for c in range(d):
            white[a, c] /= factor[a, a]
        for c in range(size):
            whole[a, c] /= factor[a, a]
        logdet += 2.0 * math.log(factor[a, d] * factor[a, a])
    np.dot(white.T, white, kept)
    np.dot(whole.T, whole, product)
    for a in range(d):
        for b in range(d):
            normal[a, b] += inverse[a, b] - product[a, b]
        for b in range(d, size):
            normal[a, b] += product[a, b]
            normal[b, a] += product[b, a]
    for a in range(d, size):
        for b in range(d, size):
            normal[a, b] += gram[a, b] - product[a, b]
    return logdet


@compiled
def invert_scaled(matrix: NDArray) -> NDArray:
    """Invert a positive matrix, each row in its own unit.

    Rounding hardly moves it. The diagonal is enlarged by what rounding may have taken, so that it
    is not singular.
    """
    size = np.sqrt(np.diag(matrix))
    unit = np.outer(size, size)
    inverse = np.linalg.inv(matrix / unit + ROUNDING * np.eye(size.size)) / unit
    return 0.5 * (inverse + inverse.T)


@compiled
def climb_omega(
    gram: NDArray, prior: Prior, omega: NDArray, rounds: int, tolerance: float
) -> tuple[NDArray, float]:
    """SQUAREM: two EM steps, one extrapolation if it gains."""
    best = -np.inf
    for _ in range(rounds):
        one = solve_gram(gram, prior, omega)
        two = solve_gram(gram, prior, one[6])
        x0, x1, x2 = pack_omega(omega), pack_omega(one[6]), pack_omega(two[6])
        step, bend = x1 - x0, x2 - 2.0 * x1 + x0
        length = np.sqrt(np.sum(step**2) / max(np.sum(bend**2), 1e-300))
        length = min(max(length, 1.0), 16.0)
        omega, value = two[6], two[5]
        away = x0 + 2.0 * length * step + length**2 * bend - x2
        most = np.max(np.abs(away[:: omega.shape[0] + 1]))  # of logarithms of sds
        trial = unpack_omega(x2 + away * FARTHEST / max(most, FARTHEST), omega.shape[0])
        if np.all(np.isfinite(trial)):
            far = solve_gram(gram, prior, trial)
            if far[5] > value:
                omega, value = far[6], far[5]
        if value - best < tolerance:
            return omega, value
        best = value
    return omega, best
