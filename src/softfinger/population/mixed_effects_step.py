"""One step of a nonlinear mixed-effects fit: as far along the linear model's answer as it holds.

Precise recordings make the likelihood a narrow valley: a small change of φ moves every trial's η
by many of its sds, along a curve that the linear model takes for straight. So where a step leads
uphill, each trial first finds its own way back to the bottom, φ held, before the step is shortened.
"""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from softfinger.population.mixed_effects import LinearFit, Prior

Linearise = Callable[[NDArray[np.float64], NDArray[np.float64]], NDArray[np.float64]]
Place = tuple[NDArray[np.float64], NDArray[np.float64]]

SHORTENINGS = 6
RETURNS = 2  # Gauss-Newton steps of η back to the bottom of the valley


def take_step(
    linearise: Linearise,
    prior: Prior,
    linear: LinearFit,
    place: Place,
    step: Place,
    gram: NDArray[np.float64],
    longest: NDArray[np.float64],
) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]] | None:
    """Take the step, a third of it, … until the joint log posterior does not fall; None: nowhere.

    All trials and φ take the same fraction: only so is the step a way down.

    Parameters
    ----------
    linearise
        As in `fit_nonlinear`.
    linear
        The linear model's answer: its μ and Ω hold for the step.
    place, step, gram
        η (trial, d) and φ (p,) now; what is added to them; Gram matrices there.
    longest
        (d,) longest step of η.
    """
    now = _penalise(prior, linear, *place, gram)
    fraction = 1.0 / max(1.0, np.max(np.abs(step[0]) / longest))
    for _ in range(SHORTENINGS):
        own, shared = (p + fraction * s for p, s in zip(place, step, strict=True))
        for correction in range(RETURNS + 1):
            there = linearise(own, shared)
            if not np.isfinite(there).all():
                break
            value = _penalise(prior, linear, own, shared, there)
            if value <= now + 1e-6 * abs(now) + 0.01:
                return own, shared, there
            if correction < RETURNS:
                own = own + _step_back(linear, own, there, longest)
        fraction /= 3.0
    return None


def _step_back(linear: LinearFit, own: NDArray, gram: NDArray, longest: NDArray) -> NDArray:
    """Gauss-Newton step of every trial's η at fixed φ, μ and Ω."""
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
