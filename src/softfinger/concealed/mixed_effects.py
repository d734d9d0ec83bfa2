"""The oracle's own evidence: a linear mixed model.

Its trials are linearised, and everything is integrated.

Each trial, whitened and linearised about η*, φ*, reads r = A (η − η*) + B (φ − φ*) + e with
e ~ N(0, 1), η ~ N(μ, diag ω²) its own parameters and φ those of the effects. η, μ ~ N(m, s²) and
φ ~ N(f, g²) are integrated exactly, log ω ~ N(l, d²) by Laplace.
"""

from dataclasses import dataclass

import numpy as np
from scipy.optimize import minimize

from softfinger.concealed.arrays import Array
from softfinger.concealed.population import PAPER_MEAN, PAPER_SD

MEAN_CENTRE = PAPER_MEAN.ravel()
MEAN_SD = np.repeat([1.0, 1.0, 1.0, 0.05], PAPER_MEAN.shape[1])
SPREAD_CENTRE = np.log(PAPER_SD.ravel())
SPREAD_SD = 0.5  # of log ω


@dataclass(frozen=True)
class Linearised:
    """Products of the whitened trials for the evidence.

    With X = [A, B]: XᵀX, Xᵀr, rᵀr of every trial, and where it was linearised.
    """

    gram: Array  # (trial, own + effect, own + effect)
    push: Array  # (trial, own + effect)
    square: Array  # (trial,)
    point: Array  # (trial, own + effect) η*, φ*
    times: float = 1.0  # each trial represents so many like it


@dataclass(frozen=True)
class Solution:
    """The mixed model solved: its evidence and its modes."""

    log_evidence: float  # without the −N/2 log 2π and the whitening, which every model shares
    log_spread: Array  # (own,) log ω
    mean: Array  # (own,) μ
    own: Array  # (trial, own) η
    effect: Array  # (effect,) φ
    effect_sd: Array  # (effect,)
    contributions: Array  # (trial,) log p(trial | the other trials), ω as it is

    @property
    def point(self) -> Array:
        """(trial, own + effect): η, φ."""
        return np.column_stack([self.own, np.tile(self.effect, (len(self.own), 1))])


@dataclass(frozen=True)
class _Moments:
    value: float
    slope: Array  # (own,) in log ω
    fixed: Array  # (own + effect,) μ, φ
    covariance: Array
    own: Array
    contributions: Array


def solve_mixed_model(
    trials: Linearised, centre: Array, sd: Array, log_spread: Array | None = None
) -> Solution:
    """Maximise over log ω, integrate over everything else.

    Parameters
    ----------
    centre, sd : array (effect,)
        Prior of φ.
    log_spread : array (own,), optional
        Where the search starts.
    """
    own = SPREAD_CENTRE.size

    def negative(log_spread: Array) -> tuple[float, Array]:
        moments = _integrate(trials, centre, sd, log_spread)
        off = (log_spread - SPREAD_CENTRE) / SPREAD_SD
        return 0.5 * off @ off - moments.value, off / SPREAD_SD - moments.slope

    start = SPREAD_CENTRE if log_spread is None else log_spread
    found = minimize(negative, start, jac=True, method="L-BFGS-B")
    nudges = 1e-4 * np.eye(own)
    curvature = np.stack(
        [(negative(found.x + h)[1] - negative(found.x - h)[1]) / 2e-4 for h in nudges]
    )
    volume = np.linalg.slogdet(0.5 * (curvature + curvature.T))[1] + 2 * own * np.log(SPREAD_SD)
    moments = _integrate(trials, centre, sd, found.x)
    return Solution(
        log_evidence=-found.fun - 0.5 * volume,
        log_spread=found.x,
        mean=moments.fixed[:own],
        own=moments.own,
        effect=moments.fixed[own:],
        effect_sd=np.sqrt(np.diag(moments.covariance)[own:]),
        contributions=moments.contributions,
    )


def _integrate(trials: Linearised, centre: Array, sd: Array, log_spread: Array) -> _Moments:
    """Log evidence at a given ω, and its slope.

    The slope is in log ω (Fisher's identity). The moments are returned too.

    Quadratic forms are evaluated at their optimum from r, which is small there; the textbook
    difference of large squares would lose whole nats.
    """
    own = log_spread.size
    precision = np.exp(-2.0 * log_spread)
    inner = np.linalg.inv(trials.gram[:, :own, :own] + np.diag(precision))
    reach = inner @ trials.gram[:, :own]  # (trial, own, fixed): how η follows μ and φ
    shifted = trials.push + np.einsum("tij,tj->ti", trials.gram, trials.point)
    pull = np.einsum("tij,tj->ti", inner, shifted[:, :own])
    gram = trials.gram - trials.gram[:, :, :own] @ reach
    push = shifted - np.einsum("tfi,ti->tf", trials.gram[:, :, :own], pull)

    prior_centre = np.concatenate([MEAN_CENTRE, centre])
    prior = np.concatenate([MEAN_SD, sd]) ** -2.0
    total = trials.times * gram.sum(0) + np.diag(prior)
    force = trials.times * push.sum(0) + prior * prior_centre
    fixed = np.linalg.solve(total, force)
    covariance = np.linalg.inv(total)

    off = pull - np.einsum("tif,f->ti", reach, fixed)  # η − μ
    best = np.concatenate([fixed[:own] + off, np.tile(fixed[own:], (len(off), 1))], axis=1)
    move = best - trials.point
    misfit = (
        trials.square
        - 2.0 * np.einsum("ti,ti->t", move, trials.push)
        + np.einsum("ti,tij,tj->t", move, trials.gram, move)
        + (off**2 * precision).sum(1)
    )
    volume = 2.0 * log_spread.sum() - np.linalg.slogdet(inner)[1]
    from_prior = prior @ (fixed - prior_centre) ** 2 - np.log(prior).sum()
    log_total = np.linalg.slogdet(total)[1]
    value = -0.5 * (trials.times * (misfit + volume).sum() + from_prior + log_total)

    spread = np.einsum("tif,fg,tig->ti", reach, covariance, reach)
    second = np.einsum("tii->ti", inner) + off**2 + spread
    return _Moments(
        value=float(value),
        slope=trials.times * (second * precision - 1.0).sum(0),
        fixed=fixed,
        covariance=covariance,
        own=best[:, :own],
        contributions=-0.5 * (misfit + volume + _hold_out(total, force, gram, push)),
    )


def _hold_out(total: Array, force: Array, gram: Array, push: Array) -> Array:
    """Each trial's cost of learning from others."""
    fixed = np.linalg.solve(total, force)
    rest = total - gram
    move = fixed - np.linalg.solve(rest, (force - push)[..., None])[..., 0]
    volume = np.linalg.slogdet(total)[1] - np.linalg.slogdet(rest)[1]
    return np.einsum("tf,tfg,tg->t", move, rest, move) + volume
