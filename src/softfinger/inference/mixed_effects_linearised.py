"""The mixed-effects model linearised, solved and bounded."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import lsq_linear

from softfinger.inference.mixed_effects import (
    LinearFit,
    Prior,
    fit_linear,
    hold_omega,
)
from softfinger.inference.rectangle import measure_rectangle

RIDGE = 1e-13  # of a correlation matrix, which may have lost its rank


class SharedBounds(NamedTuple):
    """Bounds and longest steps of φ (p,)."""

    low: NDArray[np.float64]
    high: NDArray[np.float64]
    step: NDArray[np.float64]


def solve_linearised(
    gram: NDArray[np.float64],
    prior: Prior,
    bounds: SharedBounds,
    place: tuple[NDArray[np.float64], NDArray[np.float64]],
    omega: NDArray[np.float64],
    *,
    rounds: int = 0,
) -> tuple[LinearFit, float]:
    """Solve the model linearised at (η, φ).

    Its log evidence includes the bounds.

    Parameters
    ----------
    gram
        (trial, …) of [∂F/∂η | ∂F/∂φ | residual] at `place`.
    rounds
        Of EM for Ω; 0 keeps it.
    """
    moved, near, centre = centre_gram(gram, prior, *place)
    linear = fit_linear(moved, near, omega, rounds=rounds) if rounds else None
    linear = _restore(linear or hold_omega(moved, near, omega), centre)
    d = len(omega)
    found = linear.shared[d:], linear.shared_covariance[d:, d:]
    priors = prior.mean[d:], prior.precision[d:] ** -0.5
    return linear, linear.log_evidence + compute_cut_array(*found, *priors, bounds)


def measure_linearised(
    gram: NDArray[np.float64],
    prior: Prior,
    bounds: SharedBounds,
    place: tuple[NDArray[np.float64], NDArray[np.float64]],
    omega: NDArray[np.float64],
    rounds: int,
) -> float:
    """Log evidence as of `solve_linearised`.

    It is −∞ where the model is so far from the recordings that its equations have no solution.
    """
    try:
        return solve_linearised(gram, prior, bounds, place, omega, rounds=rounds)[1]
    except np.linalg.LinAlgError:
        return -np.inf


def compute_cut_array(
    mean: NDArray[np.float64],
    covariance: NDArray[np.float64],
    prior_mean: NDArray[np.float64],
    prior_sd: NDArray[np.float64],
    bounds: SharedBounds,
) -> float:
    """Compute what bounds add to a log evidence.

    Log posterior mass inside − log prior mass inside.

    >>> far = SharedBounds(np.zeros(1), np.full(1, np.inf), np.ones(1))
    >>> one = np.ones(1)
    >>> round(compute_cut_array(9 * one, np.eye(1), 0 * one, one, far), 6)  # half-normal prior
    0.693147
    """
    covariance = np.ascontiguousarray(covariance)  # a part of a larger one, as it comes
    inside = measure_rectangle(mean, covariance, bounds.low, bounds.high)
    return inside - measure_rectangle(prior_mean, np.diag(prior_sd**2), bounds.low, bounds.high)


def centre_gram(
    gram: NDArray[np.float64],
    prior: Prior,
    own: NDArray[np.float64],
    shared: NDArray[np.float64],
) -> tuple[NDArray[np.float64], Prior, NDArray[np.float64]]:
    """State a linearised model in differences.

    Only differences keep the digits of very precise recordings.

    Parameters
    ----------
    gram
        (trial, …) of [A | B | residual] at η = `own` and φ = `shared`.

    Returns
    -------
    moved, prior, centre
        Gram matrices of [A | B | z] for fits; the prior about the centre; the centre (d + p,), to
        be added to a fit's μ, φ and η.
    """
    middle = own.mean(axis=0)
    centre = np.concatenate([middle, shared])
    away, d = own - middle, own.shape[1]
    moved = gram.copy()  # only the last column changes: z = A (η − μ) + residual
    added = np.einsum("tab,tb->ta", gram[:, :, :d], away)
    moved[:, :, -1] += added
    moved[:, -1, :] += added
    moved[:, -1, -1] += np.einsum("ta,ta->t", added[:, :d], away)
    return moved, prior._replace(mean=prior.mean - centre), centre


def _restore(linear: LinearFit, centre: NDArray) -> LinearFit:
    d = len(linear.omega)
    return linear._replace(shared=linear.shared + centre, own=linear.own + centre[:d])


def hold_bounds(
    moved: NDArray, prior: Prior, bounds: SharedBounds, linear: LinearFit, centre: NDArray
) -> tuple[LinearFit, NDArray]:
    """Keep φ within bounds and steps; η and μ follow φ."""
    d = len(linear.omega)
    low = np.maximum(bounds.low - centre[d:], -bounds.step)
    high = np.minimum(bounds.high - centre[d:], bounds.step)
    wanted = linear.shared[d:]
    if np.all((low <= wanted) & (wanted <= high)):
        return _restore(linear, centre), wanted + centre[d:]
    target = find_nearest(wanted, linear.shared_covariance[d:, d:], low, high)
    own = np.append(np.arange(d), len(centre))
    fixed = np.eye(len(centre) + 1)[:, own]  # the residual without what φ adds
    fixed[d:-1, -1] = -target
    known = prior._replace(mean=prior.mean[:d], precision=prior.precision[:d])
    follows = hold_omega(fixed.T @ moved @ fixed, known, linear.omega)
    linear = linear._replace(
        shared=np.append(follows.shared, target),
        own=follows.own,
        own_covariance=follows.own_covariance,
    )
    return _restore(linear, centre), target + centre[d:]


def find_nearest(
    mean: NDArray[np.float64],
    covariance: NDArray[np.float64],
    low: NDArray[np.float64],
    high: NDArray[np.float64],
) -> NDArray[np.float64]:
    """Most probable point of a normal density within bounds.

    A coordinate that is moved to its bound takes the others along.

    >>> covariance = np.array([[1.0, 0.5], [0.5, 1.0]])
    >>> find_nearest(np.array([-1.0, 1.0]), covariance, np.zeros(2), np.full(2, 9.0)).round(6)
    array([0. , 1.5])
    """
    variance = np.diag(covariance)
    seen = variance > 0.0  # rounding may leave none: such a coordinate takes none along
    size = np.sqrt(np.where(seen, variance, 1.0))
    scaled = np.where(np.outer(seen, seen), covariance / np.outer(size, size), 0.0)
    np.fill_diagonal(scaled, 1.0)
    spread, along = np.linalg.eigh(scaled)  # by rounding, a spread may be less than nothing
    root = (along / np.sqrt(np.maximum(spread, RIDGE))).T
    edges = low / size, high / size
    found = lsq_linear(root, root @ (mean / size), edges, method="bvls").x
    return np.clip(found * size, low, high)
