"""The misfit of the mixed-effects model linearised at a place.

Ω is fixed; the population's means μ stand beside the shared parameters φ.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from softfinger.inference.mixed_effects import Prior
from softfinger.inference.mixed_effects_linearised import RIDGE, SharedBounds, find_nearest

Place = tuple[NDArray[np.float64], NDArray[np.float64]]


class Longest(NamedTuple):
    """Longest steps of η (d,); bounds and longest steps of (μ, φ)."""

    own: NDArray[np.float64]
    bounds: SharedBounds

    @classmethod
    def limit(cls, own: NDArray[np.float64], bounds: SharedBounds) -> "Longest":
        """Limits of η and φ; μ follows freely."""
        free = np.full(len(own), np.inf)
        pairs = zip((-free, free, free), bounds, strict=True)
        return cls(own, SharedBounds(*(np.append(mean, shared) for mean, shared in pairs)))

    def hold(self, place: Place, step: NDArray, covariance: NDArray) -> NDArray:
        """The most probable step of (μ, φ) within the bounds."""
        low, high = self.bounds.low - place[1], self.bounds.high - place[1]
        if np.all((low <= step) & (step <= high)):
            return step
        return find_nearest(step, covariance, low, high)

    def measure(self, step: Place) -> float:
        """Length of a step, in the longest ones."""
        own, shared = np.abs(step[0]) / self.own, np.abs(step[1]) / self.bounds.step
        return float(max(np.max(own), np.max(shared, initial=0.0)))

    def weigh(self, step: Place) -> Place:
        """A step over the longest ones' squares."""
        return step[0] / self.own**2, step[1] / self.bounds.step**2


class Quadratic(NamedTuple):
    """Half the linear model's misfit, priors included, about a place.

    Attributes
    ----------
    within, across, beside
        (trial, d, d), (trial, d, d + p), (d + p, d + p): its curvature in η and η, η and (μ, φ),
        (μ, φ) and (μ, φ).
    own, shared
        (trial, d), (d + p,): its slope downwards.
    value
        It at the place [nats].
    """

    within: NDArray[np.float64]
    across: NDArray[np.float64]
    beside: NDArray[np.float64]
    own: NDArray[np.float64]
    shared: NDArray[np.float64]
    value: float

    def expect(self, step: Place) -> float:
        """Expected gain of a step [nats]."""
        own, shared = step
        bent = np.sum(own * np.einsum("tij,tj->ti", self.within, own))
        bent += 2.0 * np.einsum("ti,tij,j->", own, self.across, shared)
        bent += shared @ self.beside @ shared
        return float(np.sum(own * self.own) + shared @ self.shared - bent / 2.0)

    def promise(self, step: Place) -> float:
        """What the linear model's answer promises [nats].

        All of the misfit where the answer is worse than no step: then it is rounding, in a
        direction that the recordings hardly show.
        """
        expected = self.expect(step)
        slight = 1e-6 * abs(self.value) + 0.005
        return expected if expected >= -slight else abs(self.value)

    def damp(self, damping: float, longest: Longest) -> "Quadratic":
        """Add curvature, in units of the longest steps."""
        within = self.within + damping * np.diag(longest.own**-2.0)
        beside = self.beside + damping * np.diag(longest.bounds.step**-2.0)
        return self._replace(within=within, beside=beside)

    def solve(self, own: NDArray, shared: NDArray) -> tuple[NDArray, NDArray, NDArray, NDArray]:
        """Solve for right-hand sides (trial, d, k), (d + p, k).

        Returns η (trial, d, k) where (μ, φ) is 0, what (μ, φ) adds to it (trial, d, d + p), (μ, φ)
        (d + p, k) and its covariance.
        """
        k = own.shape[2]
        solved = np.linalg.solve(self.within, np.concatenate([own, self.across], axis=2))
        alone, follows = solved[..., :k], -solved[..., k:]
        left = self.beside + np.einsum("tdp,tdq->pq", self.across, follows)
        push = shared - np.einsum("tdp,tdk->pk", self.across, alone)
        least = RIDGE * np.diag(self.beside)  # rounding may leave less than nothing
        size = np.sqrt(np.maximum(np.diag(left), least))
        covariance = np.linalg.inv(left / np.outer(size, size)) / np.outer(size, size)
        return alone, follows, covariance @ push, covariance


def settle(
    prior: Prior, omega: NDArray[np.float64], own: NDArray[np.float64], shared: NDArray[np.float64]
) -> Place:
    """Place with the population's best means: η, (μ, φ)."""
    d = len(omega)
    inverse, precision = np.linalg.inv(omega), prior.precision[:d]
    pull = inverse @ own.sum(axis=0) + precision * prior.mean[:d]
    return own, np.append(np.linalg.solve(len(own) * inverse + np.diag(precision), pull), shared)


def expand(
    prior: Prior, omega: NDArray[np.float64], place: Place, gram: NDArray[np.float64]
) -> Quadratic:
    """Expand the linear model's misfit about η and (μ, φ), Ω fixed."""
    own, shared = place
    d, m = len(omega), gram.shape[1] - 1
    inverse, away, off = np.linalg.inv(omega), own - shared[:d], shared - prior.mean
    pulled, held = away @ inverse, prior.precision * off
    across = np.concatenate([np.tile(-inverse, (len(own), 1, 1)), gram[:, :d, d:m]], axis=2)
    beside, down = np.diag(prior.precision), -held
    beside[:d, :d] += len(own) * inverse
    beside[d:, d:] += gram[:, d:m, d:m].sum(axis=0)
    down[:d] += pulled.sum(axis=0)
    down[d:] += gram[:, d:m, -1].sum(axis=0)
    value = gram[:, -1, -1].sum() + np.sum(pulled * away) + held @ off
    slope = gram[:, :d, -1] - pulled
    return Quadratic(gram[:, :d, :d] + inverse, across, beside, slope, down, float(value) / 2.0)


def add(place: Place, step: Place) -> Place:
    """Place that a step leads to."""
    return place[0] + step[0], place[1] + step[1]
