"""How far recordings would tell survivors apart.

Under a survivor b the n trials of a plan are normal,

    y ~ N(F_b + J_b (μ_b − η_b), 1 + J_b Ω_b J_bᵀ, + U_b Σ_b U_bᵀ over all trials),

own parameters integrated over the population, shared ones over their posterior Σ_b. F_b, J_b
and U_b are taken at the trials that were recorded. The expected log ratio, where a is true,

    E_a[log p_a(y) − log p_b(y)]

is closed; how sure a verdict would be is drawn.

References
----------
Lindley (1956), Ann. Math. Stat. 27, 986. Box, Hill (1967), Technometrics 9, 57.
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from softfinger.mismatch.decisions import DECISIONS
from softfinger.mismatch.experiment.outlook import Foreseen


class TrialsDensity:
    """A survivor's density of all planned trials."""

    def __init__(self, foreseen: Foreseen) -> None:
        own, size = foreseen.own, len(foreseen.covariance)
        self.centre = foreseen.centre
        gram = own.transpose(0, 2, 1) @ own
        inner = np.linalg.inv(np.linalg.inv(foreseen.omega) + gram)
        self.precision = np.eye(own.shape[1]) - own @ inner @ own.transpose(0, 2, 1)
        self.pulled = self.precision @ foreseen.moved
        shared = np.einsum("tcs,tcr->sr", foreseen.moved, self.pulled)
        self.inside = np.linalg.inv(np.linalg.inv(foreseen.covariance) + shared)
        volumes = np.linalg.slogdet(np.eye(len(gram[0])) + foreseen.omega @ gram)[1]
        self.logdet = float(volumes.sum())
        self.logdet += float(np.linalg.slogdet(np.eye(size) + foreseen.covariance @ shared)[1])

    def measure_square(self, away: NDArray[np.float64]) -> NDArray[np.float64]:
        """Mahalanobis distance squared of (…, trial, c)."""
        direct = np.einsum("...tc,tce,...te->...", away, self.precision, away, optimize=True)
        pull = np.einsum("...tc,tcs->...s", away, self.pulled, optimize=True)
        return direct - np.einsum("...s,sr,...r->...", pull, self.inside, pull, optimize=True)

    def measure_trace(self, true: Foreseen) -> float:
        """Trace of the inverse covariance times another's."""
        both = np.einsum("tcs,tcr->sr", self.pulled, self.pulled)
        total = np.einsum("tcc->", self.precision) - np.sum(self.inside * both)
        own = true.own @ np.linalg.cholesky(true.omega)
        total += np.einsum("tck,tce,tek->", own, self.precision, own, optimize=True)
        pull = np.einsum("tck,tcs->tks", own, self.pulled)
        total -= np.einsum("tks,sr,tkr->", pull, self.inside, pull, optimize=True)
        return float(total + self.measure_square(spread_shared(true)).sum())

    def score(self, values: NDArray[np.float64]) -> NDArray[np.float64]:
        """Log density (…,) of (…, trial, c), without 2π."""
        return -0.5 * (self.measure_square(values - self.centre) + self.logdet)


def spread_shared(foreseen: Foreseen) -> NDArray[np.float64]:
    """Directions (d + p, trial, c) of sd 1 in which θ moves trials."""
    values, vectors = np.linalg.eigh(foreseen.covariance)
    factor = vectors * np.sqrt(np.maximum(values, 0.0))
    return np.einsum("tcs,sk->ktc", foreseen.moved, factor)


def expect_log_ratio(foreseen: Sequence[Foreseen]) -> NDArray[np.float64]:
    """Expected evidence (true, other) [nats] against others.

    0 on the diagonal.

    Examples
    --------
    One trial of one number, of unit noise and no spread, 3 apart:

    >>> empty = np.zeros((1, 1, 1))
    >>> sure = dict(own=empty, moved=empty, omega=np.eye(1), covariance=np.eye(1))
    >>> near, far = (Foreseen(np.full((1, 1), place), **sure) for place in (0.0, 3.0))
    >>> expect_log_ratio([near, far])
    array([[0. , 4.5],
           [4.5, 0. ]])
    """
    densities = [TrialsDensity(part) for part in foreseen]
    expected = np.zeros((len(foreseen), len(foreseen)))
    for a, true in enumerate(foreseen):
        for b, density in enumerate(densities):
            square = density.measure_square(true.centre - density.centre)
            square += density.measure_trace(true)
            expected[a, b] = -0.5 * (square + density.logdet)
    return np.diag(expected)[:, None] - expected


def bound_gain(ratio: NDArray[np.float64], weight: NDArray[np.float64], needed: float) -> float:
    """Mean over pairs of a gain that is bounded [nats].

    A pair of expected evidence r counts needed (1 − exp(−r / needed)): what is sure need not be
    surer, and what no protocol shows draws no effort away.

    Parameters
    ----------
    ratio, weight
        (true, other); weights need not sum to 1.

    >>> two = np.array([[0.0, 4.0], [4.0, 0.0]])
    >>> round(bound_gain(two, 1.0 - np.eye(2), 10.0), 3)
    3.297
    """
    total = weight.sum()
    if not total > 0.0:
        return 0.0
    gain = needed * -np.expm1(-np.maximum(ratio, 0.0) / needed)
    return float(np.sum(weight * gain) / total)


def expect_sure(
    foreseen: Sequence[Foreseen],
    probability: NDArray[np.float64],
    rng: np.random.Generator,
    draws: int,
) -> tuple[float, float]:
    """Probability of a sure answer, and of a right one.

    Recordings are drawn of every survivor in turn, weighted by its probability. Sure is a survivor
    of `DECISIONS.sure` or more afterwards; right is the one that made them.
    """
    densities = [TrialsDensity(part) for part in foreseen]
    sure = right = 0.0
    for a, (true, weight) in enumerate(zip(foreseen, probability, strict=True)):
        directions = spread_shared(true)
        coefficients = rng.standard_normal((draws, len(directions)))
        drawn = true.centre + np.einsum("nk,ktc->ntc", coefficients, directions)
        own = rng.standard_normal((draws, len(true.own), len(true.omega)))
        own = own @ np.linalg.cholesky(true.omega).T
        drawn = drawn + np.einsum("tcd,ntd->ntc", true.own, own) + rng.standard_normal(drawn.shape)
        logs = np.stack([density.score(drawn) for density in densities], axis=-1)
        logs = logs + np.log(np.maximum(probability, 1e-300))
        after = np.exp(logs - np.logaddexp.reduce(logs, axis=1)[:, None])
        sure += weight * float(np.mean(after.max(axis=1) >= DECISIONS.sure))
        right += weight * float(np.mean(after[:, a] >= DECISIONS.sure))
    return sure, right
