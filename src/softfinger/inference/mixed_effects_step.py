"""One step of a nonlinear mixed-effects fit.

It goes as far along the linear model's answer as that is valid.

Precise recordings make the likelihood a narrow valley: a small change of φ moves every trial's η
by many of its sds, along a curve that the linear model takes for straight. So where a step leads
uphill, each trial first returns to the bottom at fixed φ, before the step is shortened.
Where each answer takes about the last step back, only a part of a step is taken.
"""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from softfinger.inference.budget import BUDGET
from softfinger.inference.mixed_effects import LinearFit, Prior

Linearise = Callable[[NDArray[np.float64], NDArray[np.float64]], NDArray[np.float64]]
Place = tuple[NDArray[np.float64], NDArray[np.float64]]


class Taken(NamedTuple):
    """Result of a step.

    η, φ and Gram matrices after it, the fraction of it that was taken, and what it took.
    """

    own: NDArray[np.float64]
    shared: NDArray[np.float64]
    gram: NDArray[np.float64]
    fraction: float
    tries: int


class Relaxation(NamedTuple):
    """How much of a wanted change may be taken.

    Attributes
    ----------
    most
        Largest fraction of the next change.
    wanted, fraction
        The last change that was wanted, and the fraction of it that was taken.
    count
        Changes so far.
    """

    most: float = 1.0
    wanted: NDArray[np.float64] | None = None
    fraction: float = 1.0
    count: int = 0

    def limit(self, now: NDArray[np.float64]) -> float:
        """Fraction of a wanted change that comes to rest.

        Near its end a wanted change s leaves (1 − c f) s when a fraction f of it is taken: c > 1
        overshoots, and 1/c of the next is right. The fraction grows again, but slower
        with each change: where c itself changes, a fraction that grew freely would never settle.

        >>> Relaxation().take(1.0, np.array([1.0]), 1.0).limit(np.array([-0.9])).round(3)
        np.float64(0.526)
        """
        if self.wanted is None:
            return 1.0
        left = self.wanted @ now / max(self.wanted @ self.wanted, 1e-300)
        right = self.fraction / max(1.0 - left, 1e-300)
        return np.clip(min(right, (1 + 1 / self.count) * self.most), BUDGET.least_fraction, 1.0)

    def take(self, most: float, wanted: NDArray[np.float64], fraction: float) -> "Relaxation":
        """Remember a change, its fraction taken, `most` allowed."""
        return Relaxation(most, wanted, fraction, self.count + 1)


def take_step(
    linearise: Linearise,
    prior: Prior,
    linear: LinearFit,
    place: Place,
    step: Place,
    gram: NDArray[np.float64],
    longest: NDArray[np.float64],
    most: float,
) -> Taken | None:
    """Take the longest step that does not lead down.

    It tries the step, a third of it, … until the joint log posterior does not fall; None: nowhere.

    All trials and φ take the same fraction: only so is the step a way down.

    Parameters
    ----------
    linearise
        As in `fit_nonlinear`.
    linear
        The linear model's answer: its μ and Ω are fixed during the step.
    place, step, gram
        η (trial, d) and φ (p,) now; what is added to them; Gram matrices there.
    longest
        (d,) longest step of η.
    most
        Largest fraction.
    """
    now = _penalise(prior, linear, *place, gram)
    fraction = min(most, 1.0 / max(1.0, np.max(np.abs(step[0]) / longest)))
    tries = 0
    for _ in range(BUDGET.shortenings):
        own, shared = (p + fraction * s for p, s in zip(place, step, strict=True))
        for correction in range(BUDGET.returns + 1):
            there = linearise(own, shared)
            tries += 1
            if not np.isfinite(there).all():
                break
            value = _penalise(prior, linear, own, shared, there)
            if value <= now + 1e-6 * abs(now) + 0.01:
                return Taken(own, shared, there, fraction, tries)
            if correction < BUDGET.returns:
                own = own + _step_back(linear, own, there, longest)
        fraction /= 3.0
    return None


def _step_back(linear: LinearFit, own: NDArray, gram: NDArray, longest: NDArray) -> NDArray:
    """Gauss-Newton step of every η, all else fixed."""
    d = len(linear.omega)
    inverse = np.linalg.inv(linear.omega)
    pull = gram[:, :d, -1] - (own - linear.shared[:d]) @ inverse
    step = np.linalg.solve(gram[:, :d, :d] + inverse, pull[..., None])[..., 0]
    return step / np.maximum(1.0, np.max(np.abs(step) / longest, axis=1))[:, None]


def _penalise(
    prior: Prior, linear: LinearFit, own: NDArray, shared: NDArray, gram: NDArray
) -> float:
    d = len(linear.omega)
    away = own - linear.shared[:d]
    value = gram[:, -1, -1].sum() + np.sum(away @ np.linalg.inv(linear.omega) * away)
    return float(value + np.sum(prior.precision[d:] * (shared - prior.mean[d:]) ** 2))
