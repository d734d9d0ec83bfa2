"""A nonlinear mixed-effects model by repeated linearisation.

This is FOCE with Laplace's evidence.

y_i = F_i(η_i, φ) + ε_i is linearised at each trial's mode, the linear mixed model is solved from
Gram matrices, and so on until nothing moves. Shared parameters may have bounds: their normal prior
and posterior are cut there.

References
----------
Lindstrom, Bates (1990), Biometrics 46, 673. Wolfinger (1993), Biometrika 80, 791.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from softfinger.inference.budget import BUDGET
from softfinger.inference.mixed_effects import LinearFit, Prior, fit_linear, hold_omega
from softfinger.inference.mixed_effects_linearised import (
    SharedBounds,
    centre_gram,
    hold_bounds,
    solve_linearised,
)
from softfinger.inference.mixed_effects_quadratic import Longest, Place, expand, settle
from softfinger.inference.mixed_effects_step import Linearise, take_step
from softfinger.inference.omega import add_omega, subtract_omega
from softfinger.inference.relaxation import Relaxation


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
    first
        Log evidence from which its gain counts: as given, or of its first linearisation.
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
    first: float = -np.inf


def fit_nonlinear(
    linearise: Linearise,
    prior: Prior,
    bounds: SharedBounds,
    own_step: NDArray[np.float64],
    start: tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]],
    *,
    steps: int = 25,
    tolerance: float = 0.02,
    first: float = -np.inf,
    rival: float = -np.inf,
) -> Fit:
    """Fit a nonlinear mixed-effects model.

    Parameters
    ----------
    linearise
        (η (trial, d), φ (p,)) → Gram matrices of [∂F/∂η | ∂F/∂φ | y − F], whitened; not finite
        where the model has no solution.
    prior
        Priors of μ and φ (before they are cut at the bounds) and of Ω.
    own_step
        (d,) longest step of η.
    start
        η (trial, d), φ (p,), Ω (d, d).
    steps
        Most steps; where they are tried again and again, twice as many linearisations end the fit.
    tolerance
        Change of the log evidence [nats] at which it has come to rest; of a large gain, a share.
    first
        Log evidence from which the gain counts, where other fits have led to this one.
    rival
        Log evidence that is worth reaching: a fit that at its pace would end below it stops.
    """
    own, shared, omega = (np.array(a, float) for a in start)
    gram = linearise(own, shared)
    moving, spreading = Relaxation(), Relaxation()
    course, limits = Course([], []), Longest.limit(own_step, bounds)
    tries, region, converged = 0, 1.0, False
    for _ in range(steps):
        moved, near, centre = centre_gram(gram, prior, own, shared)
        linear, spreading = _spread_out(moved, near, omega, spreading)
        omega = linear.omega
        linear, _ = hold_bounds(moved, near, bounds, linear, centre)
        place = settle(prior, omega, own, shared)
        step, change = moves = linear.own - own, linear.shared - place[1]
        wanted = _scale(linear, moves)
        most = moving.limit(wanted)
        lack = expand(prior, omega, place, gram).promise(moves)
        answer = most * step, most * change
        taken = take_step(linearise, prior, omega, place, answer, gram, limits, region)
        if taken is None:
            converged = bool(course.evidence)
            break
        made = taken.own - own
        own, shared, gram, fraction, more, region = taken
        fraction *= most
        tries += more
        moving = moving.take(most, wanted, fraction)
        # a trial whose step leads back to where it was is at rest, whatever it wants
        far = np.minimum(np.abs(step), np.abs(made) / fraction)
        still = np.all(far <= 0.05 * _spread(linear))
        evidence = linear.log_evidence - lack
        first = evidence if np.isinf(first) else first
        slight = tolerance + BUDGET.rest_share * abs(evidence - first)
        course = course.go_on(evidence, float(gram[:, -1, -1].sum()))
        converged = course.is_at_rest(slight, still=still)
        if converged or course.has_stalled(slight):
            break
        if tries > 2 * steps or max(course.extrapolate(steps), linear.log_evidence) < rival:
            break
    return _finish(gram, prior, bounds, own, shared, omega, converged=converged, first=first)


class Course(NamedTuple):
    """Log evidence [nats] and misfit [χ²] after each step."""

    evidence: list[float]
    misfit: list[float]

    def go_on(self, evidence: float, misfit: float) -> "Course":
        """Add a step."""
        return Course([*self.evidence, evidence], [*self.misfit, misfit])

    def extrapolate(self, steps: int) -> float:
        """Log evidence that a fit would reach.

        It is what so many steps would give if each gained as much as the best of the last ones.

        >>> Course([0.0, 1.0, 4.0, 5.0, 5.5], []).extrapolate(15)
        35.5
        """
        seen = self.evidence
        if len(seen) <= BUDGET.recent:
            return np.inf
        pace = max(*np.diff(seen[-1 - BUDGET.recent :]), 0.0)
        return float(seen[-1] + pace * (steps - len(seen)))

    def has_stalled(self, slight: float) -> bool:
        """Whether the last steps led no higher than those before.

        >>> Course([5.0, 4.0] * BUDGET.pace, [1.0, 2.0] * BUDGET.pace).has_stalled(0.01)
        True
        """
        if len(self.evidence) < 2 * BUDGET.pace:
            return False
        last, before = slice(-BUDGET.pace, None), slice(-2 * BUDGET.pace, -BUDGET.pace)
        no_higher = max(self.evidence[last]) <= max(self.evidence[before]) + slight
        return no_higher and min(self.misfit[last]) >= min(self.misfit[before]) - slight

    def is_at_rest(self, slight: float, *, still: bool) -> bool:
        """Whether the evidence has settled, at one place or going round it."""
        if self.has_stalled(slight):
            return bool(np.ptp(self.evidence[-BUDGET.pace :]) < slight)
        return still and len(self.evidence) > 1 and abs(np.diff(self.evidence[-2:])[0]) < slight


def _spread_out(
    moved: NDArray, near: Prior, omega: NDArray, spreading: Relaxation
) -> tuple[LinearFit, Relaxation]:
    """The linear model's answer, Ω relaxed."""
    linear = fit_linear(moved, near, omega)
    change = subtract_omega(linear.omega, omega)
    part = spreading.limit(change)
    if part < 1.0:
        linear = hold_omega(moved, near, add_omega(omega, part * change))
    return linear, spreading.take(part, change, part)


def _finish(
    gram: NDArray,
    prior: Prior,
    bounds: SharedBounds,
    own: NDArray,
    shared: NDArray,
    omega: NDArray,
    *,
    converged: bool,
    first: float,
) -> Fit:
    """The fit at a place.

    Far from the best, the Ω that suits the linear model's answer does not suit the place.
    """
    d = len(omega)
    place = own, shared
    solved = (solve_linearised(gram, prior, bounds, place, omega, rounds=n) for n in (30, 0))
    told = [(e - _find_lack(gram, prior, bounds, place, li.omega), li) for li, e in solved]
    evidence, linear = max(told, key=lambda pair: pair[0])
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
        float(first),
    )


def _find_lack(
    gram: NDArray, prior: Prior, bounds: SharedBounds, place: Place, omega: NDArray
) -> float:
    """What a place lacks of the linear model's best [nats].

    Far from the best the linear model promises what no place has.
    """
    moved, near, centre = centre_gram(gram, prior, *place)
    linear, _ = hold_bounds(moved, near, bounds, hold_omega(moved, near, omega), centre)
    own, shared = settle(prior, omega, *place)
    return expand(prior, omega, (own, shared), gram).promise(
        (linear.own - own, linear.shared - shared)
    )


def _scale(linear: LinearFit, moves: tuple[NDArray, NDArray]) -> NDArray:
    """A step in units of its uncertainty."""
    d = len(linear.omega)
    variance = np.diag(linear.shared_covariance)[d:]  # rounding may leave one below 0
    sd = np.sqrt(np.maximum(variance, 0.0)) + 1e-12
    return np.concatenate([(moves[0] / _spread(linear)).ravel(), moves[1][d:] / sd])


def _spread(linear: LinearFit) -> NDArray:
    return np.sqrt(np.einsum("tii->ti", linear.own_covariance)) + 1e-12
