"""A nonlinear mixed-effects model by repeated linearisation: FOCE with Laplace's evidence.

y_i = F_i(η_i, φ) + ε_i is linearised at each trial's mode, the linear mixed model is solved from
Gram matrices, and so on until nothing moves. Shared parameters may have bounds: their normal prior
and posterior are cut there, each by itself.

References
----------
Lindstrom, Bates (1990), Biometrics 46, 673. Wolfinger (1993), Biometrika 80, 791.
"""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.stats import norm

from softfinger.population.mixed_effects import LinearFit, Prior, fit_linear, hold_omega

Linearise = Callable[[NDArray[np.float64], NDArray[np.float64]], NDArray[np.float64]]

PINNED = 1e12  # precision, over the prior's, of a parameter held at its bound
HALVINGS = 5


class SharedBounds(NamedTuple):
    """Bounds and longest steps of the shared parameters φ (p,)."""

    low: NDArray[np.float64]
    high: NDArray[np.float64]
    step: NDArray[np.float64]


class Fit(NamedTuple):
    """A nonlinear mixed-effects fit.

    Attributes
    ----------
    own, own_covariance
        (trial, d), (trial, d, d): modes of η_i, and covariance given μ and φ.
    mean, mean_covariance
        (d,), (d, d): μ.
    shared, shared_covariance
        (p,), (p, p): φ.
    omega
        (d, d).
    log_evidence
        [nats], without the constants of the noise and of Ω's prior.
    gram
        (trial, d + p + 1, d + p + 1) of [∂F/∂η | ∂F/∂φ | residual] at the modes, whitened.
    converged
        Whether it came to rest.
    """

    own: NDArray[np.float64]
    own_covariance: NDArray[np.float64]
    mean: NDArray[np.float64]
    mean_covariance: NDArray[np.float64]
    shared: NDArray[np.float64]
    shared_covariance: NDArray[np.float64]
    omega: NDArray[np.float64]
    log_evidence: float
    gram: NDArray[np.float64]
    converged: bool

    @property
    def chi_square(self) -> NDArray[np.float64]:
        """Squared whitened residual of each trial at its mode (trial,)."""
        return self.gram[:, -1, -1]


def fit_nonlinear(
    linearise: Linearise,
    prior: Prior,
    bounds: SharedBounds,
    own_step: NDArray[np.float64],
    start: tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]],
    *,
    steps: int = 25,
    tolerance: float = 0.02,
) -> Fit:
    """Fit a nonlinear mixed-effects model.

    Parameters
    ----------
    linearise
        (η (trial, d), φ (p,)) → Gram matrices of [∂F/∂η | ∂F/∂φ | y − F], whitened; not finite
        where the model has no solution.
    prior
        Priors of μ and φ (before they are cut at the bounds) and of Ω.
    bounds
        Bounds and longest steps of φ.
    own_step
        (d,) longest step of η.
    start
        η (trial, d), φ (p,), Ω (d, d).
    steps
        Most linearisations.
    tolerance
        Change of the log evidence [nats] at which it has come to rest.
    """
    own, shared, omega = (np.array(a, float) for a in start)
    gram = linearise(own, shared)
    best = -np.inf
    for _ in range(steps):
        moved = shift_gram(gram, own, shared)
        linear = fit_linear(moved, prior, omega)
        omega = linear.omega
        linear, target = _hold_bounds(moved, prior, bounds, linear, shared)
        step = _limit(linear.own - own, own_step)
        candidate = _search(linearise, prior, linear, (own, shared), (step, target - shared), gram)
        evidence = linear.log_evidence
        if candidate is None:
            break
        own, shared, gram = candidate
        still = np.all(np.abs(step) <= 0.05 * _spread(linear))
        if abs(evidence - best) < tolerance and still:
            best = evidence
            break
        best = evidence
    else:
        return _finish(gram, prior, bounds, own, shared, omega, converged=False)
    return _finish(gram, prior, bounds, own, shared, omega, converged=np.isfinite(best))


def _finish(
    gram: NDArray,
    prior: Prior,
    bounds: SharedBounds,
    own: NDArray,
    shared: NDArray,
    omega: NDArray,
    *,
    converged: bool,
) -> Fit:
    d = len(omega)
    linear, evidence = solve_linearised(gram, prior, bounds, (own, shared), omega, rounds=30)
    covariance = linear.shared_covariance
    return Fit(
        own,
        linear.own_covariance,
        linear.shared[:d],
        covariance[:d, :d],
        shared,
        covariance[d:, d:],
        linear.omega,
        evidence,
        gram,
        bool(converged),
    )


def solve_linearised(
    gram: NDArray[np.float64],
    prior: Prior,
    bounds: SharedBounds,
    place: tuple[NDArray[np.float64], NDArray[np.float64]],
    omega: NDArray[np.float64],
    *,
    rounds: int = 0,
) -> tuple[LinearFit, float]:
    """Solve the model linearised at (η, φ); its log evidence includes the bounds.

    Parameters
    ----------
    gram
        (trial, …) of [∂F/∂η | ∂F/∂φ | residual] at `place`.
    rounds
        Of EM for Ω; 0 holds it.
    """
    moved = shift_gram(gram, *place)
    linear = fit_linear(moved, prior, omega, rounds=rounds) if rounds else None
    linear = linear or hold_omega(moved, prior, omega)
    d = len(omega)
    sd = np.sqrt(np.diag(linear.shared_covariance)[d:])
    priors = prior.mean[d:], prior.precision[d:] ** -0.5
    cut = compute_cut_array(linear.shared[d:], sd, *priors, bounds)
    return linear, linear.log_evidence + float(cut)


def compute_cut_array(
    mean: NDArray[np.float64],
    sd: NDArray[np.float64],
    prior_mean: NDArray[np.float64],
    prior_sd: NDArray[np.float64],
    bounds: SharedBounds,
) -> float:
    """Compute what bounds add to a log evidence: log posterior mass inside − log prior mass inside.

    >>> far = SharedBounds(np.zeros(1), np.full(1, np.inf), np.ones(1))
    >>> one = np.ones(1)
    >>> compute_cut_array(9 * one, one, 0 * one, one, far).round(6)  # half-normal prior
    np.float64(0.693147)
    """
    inside = _log_mass(mean, sd, bounds)
    return (inside - _log_mass(prior_mean, prior_sd, bounds)).sum()


def _log_mass(mean: NDArray, sd: NDArray, bounds: SharedBounds) -> NDArray:
    low, high = (bounds.low - mean) / sd, (bounds.high - mean) / sd
    flip = low > 0  # the tail that loses no digits
    upper = np.where(flip, -low, high)
    lower = np.where(flip, -high, low)
    large, small = norm.logcdf(upper), norm.logcdf(lower)
    return large + np.log1p(-np.exp(np.minimum(small - large, -1e-12)))


def shift_gram(gram: NDArray, own: NDArray, shared: NDArray) -> NDArray:
    """Turn Gram matrices of [A | B | residual] into those of [A | B | residual + A η + B φ]."""
    trials, size = gram.shape[:2]
    change = np.tile(np.eye(size), (trials, 1, 1))
    change[:, :-1, -1] = np.column_stack([own, np.tile(shared, (trials, 1))])
    return change.transpose(0, 2, 1) @ gram @ change


def _hold_bounds(
    moved: NDArray, prior: Prior, bounds: SharedBounds, linear: LinearFit, shared: NDArray
) -> tuple[LinearFit, NDArray]:
    """Where φ may go: within its bounds and steps; η follows the φ that was held."""
    d = len(linear.omega)
    wanted = linear.shared[d:]
    low = np.maximum(bounds.low, shared - bounds.step)
    high = np.minimum(bounds.high, shared + bounds.step)
    target = np.clip(wanted, low, high)
    held = target != wanted
    for _ in range(len(shared)):
        if not held.any():
            break
        mean, precision = prior.mean.copy(), prior.precision.copy()
        mean[d:][held] = target[held]
        precision[d:][held] *= PINNED
        pinned = hold_omega(moved, prior._replace(mean=mean, precision=precision), linear.omega)
        wanted = np.where(held, target, pinned.shared[d:])
        target = np.clip(wanted, low, high)
        evidence = linear.log_evidence
        linear = pinned._replace(log_evidence=evidence)
        if np.all(target == wanted):
            break
        held |= target != wanted
    return linear, target


def _limit(step: NDArray, longest: NDArray) -> NDArray:
    """Shorten each trial's step until no parameter goes farther than its longest step."""
    excess = np.max(np.abs(step) / longest, axis=1, keepdims=True)
    return step / np.maximum(excess, 1.0)


def _spread(linear: LinearFit) -> NDArray:
    return np.sqrt(np.einsum("tii->ti", linear.own_covariance)) + 1e-12


def _search(
    linearise: Linearise,
    prior: Prior,
    linear: LinearFit,
    place: tuple[NDArray, NDArray],
    step: tuple[NDArray, NDArray],
    gram: NDArray,
) -> tuple[NDArray, NDArray, NDArray] | None:
    """Take the step, or half of it, …, until the joint log posterior of η and φ does not fall."""
    now = _penalise(prior, linear, *place, gram)
    fraction = 1.0
    for _ in range(HALVINGS):
        own, shared = (p + fraction * s for p, s in zip(place, step, strict=True))
        there = linearise(own, shared)
        if np.isfinite(there).all():
            value = _penalise(prior, linear, own, shared, there)
            if value <= now + 1e-6 * abs(now) + 0.01:
                return own, shared, there
        fraction /= 3.0
    return None


def _penalise(
    prior: Prior, linear: LinearFit, own: NDArray, shared: NDArray, gram: NDArray
) -> float:
    d = len(linear.omega)
    away = own - linear.shared[:d]
    value = gram[:, -1, -1].sum() + np.sum(away @ np.linalg.inv(linear.omega) * away)
    return float(value + np.sum(prior.precision[d:] * (shared - prior.mean[d:]) ** 2))
