"""One step of a nonlinear mixed-effects fit.

It goes as far along the linear model's answer as that is valid.

Precise recordings make the likelihood a narrow, bent valley. A step is the linear model's answer
where that lies within the region in which linearisations have been right, and the damped answer
that just reaches the region's edge elsewhere. From where it leads, Gauss-Newton steps across it
return to the bottom of the valley, and keep the way that was made along it. So a step may be as
long as the valley is straight, not as the valley is narrow.

References
----------
Moré (1978), Lecture Notes in Mathematics 630, 105: the region, and damping. Keller (1977), in
Applications of Bifurcation Theory, 359: corrections across a step.
"""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from softfinger.inference.budget import BUDGET
from softfinger.inference.mixed_effects import Prior
from softfinger.inference.mixed_effects_quadratic import (
    Longest,
    Place,
    Quadratic,
    add,
    expand,
    settle,
)

TINY = float(np.finfo(float).tiny)  # no division by nothing; Python's own overflows quietly
NEGLIGIBLE = 1e-200  # of what is divided: a divisor below it is none
Linearise = Callable[[NDArray[np.float64], NDArray[np.float64]], NDArray[np.float64]]


class Taken(NamedTuple):
    """Result of a step.

    η, φ and Gram matrices after it; the fraction of the answer that it made; linearisations that it
    took; the region [longest steps] for the next.
    """

    own: NDArray[np.float64]
    shared: NDArray[np.float64]
    gram: NDArray[np.float64]
    fraction: float
    tries: int
    region: float


def take_step(
    linearise: Linearise,
    prior: Prior,
    omega: NDArray[np.float64],
    place: Place,
    answer: Place,
    gram: NDArray[np.float64],
    longest: Longest,
    region: float,
) -> Taken | None:
    """Take the longest step that does not lead down.

    It tries smaller and smaller regions until the joint log posterior does not fall; None: nowhere.

    Parameters
    ----------
    linearise
        As in `fit_nonlinear`.
    omega
        Ω, fixed during the step.
    place, answer, gram
        η (trial, d) and (μ, φ) now; what the linear model adds to them; Gram matrices there.
    longest
        Longest steps and bounds.
    region
        Length [longest steps] up to which linearisations have been right.
    """
    now = expand(prior, omega, place, gram)

    def look(at: Place) -> Reached:
        own, shared = at = settle(prior, omega, at[0], at[1][len(omega) :])
        found = linearise(own, shared[len(omega) :])
        known = np.isfinite(found).all()
        return Reached(at, found, expand(prior, omega, at, found) if known else None)

    tries = 0
    for _ in range(BUDGET.shortenings):
        step = _reach(now, place, answer, longest, region)
        expected, length = now.expect(step), longest.measure(step)
        enough = now.value - BUDGET.agreed * expected
        best, more = _follow(look, add(place, step), step, longest, enough)
        tries += more
        if best.value <= now.value + 1e-6 * abs(now.value) + 0.005:
            right = (now.value - best.value) / max(expected, TINY)
            own, shared = best.place
            share = _share((own - place[0], shared - place[1]), answer, longest)
            region = _resize(region, length, right)
            return Taken(own, shared[len(omega) :], best.gram, share, tries, region)
        region = length / BUDGET.smaller
    return None


class Reached(NamedTuple):
    """A place that was tried: Gram matrices, misfit.

    There is no misfit where the model has no solution.
    """

    place: Place
    gram: NDArray[np.float64]
    misfit: Quadratic | None

    @property
    def value(self) -> float:
        """The misfit's value."""
        return np.inf if self.misfit is None else self.misfit.value


def _follow(
    look: Callable[[Place], Reached], at: Place, step: Place, longest: Longest, enough: float
) -> tuple[Reached, int]:
    """Return to the bottom of the valley; the best place, places tried."""
    best, tries = look(at), 1
    while best.value > enough and best.misfit is not None and tries <= BUDGET.returns:
        back = _return(best.misfit, best.place, step, longest)
        if back is None:
            break
        found = look(add(best.place, back))
        tries += 1
        if found.value >= best.value:
            break
        best = found
    return best, tries


def _reach(now: Quadratic, place: Place, answer: Place, longest: Longest, region: float) -> Place:
    """The step that just lies within the region."""
    length = longest.measure(answer)
    if length <= region:
        return answer
    shorter = answer[0] * region / length, answer[1] * region / length
    return _soften(lambda damped: _damp(damped, place, longest), now, longest, region) or shorter


def _soften(
    solve: Callable[[Quadratic], Place], now: Quadratic, longest: Longest, most: float
) -> Place | None:
    """The least damped solution no longer than `most`."""
    steepest = _find_steepest(now, longest)

    def try_damping(power: float) -> tuple[Place, float]:
        step = solve(now.damp(steepest * 10.0**power, longest))
        return step, longest.measure(step)

    weak, strong = BUDGET.dampings
    found, length = try_damping(weak)
    if length <= most:
        return found
    found = None
    for _ in range(BUDGET.halvings):
        middle = (weak + strong) / 2.0
        step, length = try_damping(middle)
        if not length <= most:
            weak = middle
            continue
        strong, found = middle, step
        if length >= BUDGET.edge * most:
            break
    return found


def _find_steepest(now: Quadratic, longest: Longest) -> float:
    """Largest curvature, in units of the longest steps."""
    own = np.einsum("tii->ti", now.within) * longest.own**2
    limited = np.isfinite(longest.bounds.step)
    shared = np.diag(now.beside)[limited] * longest.bounds.step[limited] ** 2
    return float(max(np.max(own), np.max(shared, initial=0.0)))


def _damp(damped: Quadratic, place: Place, longest: Longest) -> Place:
    """The damped answer within the bounds."""
    alone, follows, moved, covariance = damped.solve(damped.own[..., None], damped.shared[:, None])
    shared = longest.hold(place, moved[:, 0], covariance)
    return alone[..., 0] + follows @ shared, shared


def _return(there: Quadratic, at: Place, step: Place, longest: Longest) -> Place | None:
    """Gauss-Newton step across a step: what was made along it stays made."""
    most, along = BUDGET.farthest_back * longest.measure(step), longest.weigh(step)
    return _soften(lambda damped: _cross(damped, at, along, longest), there, longest, most)


def _cross(damped: Quadratic, at: Place, along: Place, longest: Longest) -> Place:
    """The damped answer within the bounds, in the plane across a direction."""
    right = np.stack([damped.own, along[0]], axis=2), np.stack([damped.shared, along[1]], axis=1)
    alone, follows, moved, covariance = damped.solve(*right)
    own = alone + follows @ moved
    down, up = np.einsum("ti,tik->k", along[0], own) + along[1] @ moved
    up = max(up, TINY)
    plane = covariance - np.outer(moved[:, 1], moved[:, 1]) / up
    shared = longest.hold(at, moved[:, 0] - _divide(down, up) * moved[:, 1], plane)
    back = alone[..., 0] + follows @ shared
    down, up = np.sum(along[0] * back) + along[1] @ shared, np.sum(along[0] * alone[..., 1])
    return back - _divide(down, up) * alone[..., 1], shared


def _divide(down: float, up: float) -> float:
    """How far to go back along a direction.

    It is 0 where nothing moves along it.

    >>> _divide(1.0, 2.0), _divide(1.0, 0.0), _divide(1e20, 1e-300)
    (0.5, 0.0, 0.0)
    """
    return float(down / up) if up > NEGLIGIBLE * abs(down) else 0.0


def _resize(region: float, length: float, right: float) -> float:
    """The next region, by the share of the expected gain."""
    if right < BUDGET.poor:
        return length / BUDGET.smaller
    at_the_edge = length >= BUDGET.edge * region
    larger = right >= BUDGET.agreed and at_the_edge
    return min(region * BUDGET.larger, BUDGET.largest_region) if larger else region


def _share(made: Place, answer: Place, longest: Longest) -> float:
    """Fraction of the answer that a step made."""
    own, shared = longest.weigh(answer)
    ways = [float(np.sum(own * one) + shared @ two) for one, two in (made, answer)]
    return float(np.clip(ways[0] / max(ways[1], TINY), BUDGET.least_fraction, 1.0))
