"""The posterior of a model with effects, exact up to Monte Carlo error, by Gibbs and Metropolis.

Population (μ, σ), effects φ, each trial's own η_i and the noise's scale s are sampled:

    y_i = F_i(η_i, φ) + s ε_i,   η_i ~ N(μ, diag σ²),   (μ, φ) ~ N(m, P⁻¹) within φ's bounds,
    σ² ~ ν S²/χ²_ν,   s² ~ ν_s/χ²_{ν_s};  ε_i has the covariance that was estimated without a model.

Given σ and s, the model linearised at the modes is jointly normal in (μ, φ) and η. Half of the
proposals keep that normal law invariant (preconditioned Crank–Nicolson), so that only what the full
forward model adds to it decides on acceptance; the others are random walks in its shape, for trials
of which it knows little. η follows a move of φ. σ, s and μ have exact conditionals. All chains move
side by side.

References
----------
Cotter, Roberts, Stuart, White (2013), Statistical Science 28, 424.
"""

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from softfinger.mismatch.mcmc_measure import measure_chains
from softfinger.mismatch.problem import OWN, Candidate, Problem
from softfinger.mismatch.summary import NOISE_VARIANCE_SD
from softfinger.population.mixed_effects import hold_omega
from softfinger.population.mixed_effects_laplace import centre_gram
from softfinger.progress import track_progress

REACHES = (1.0, 0.6, 0.2, 0.07)  # √(1 − ρ²) of proposals: bold, and timid where it is bent
FLOW = 2  # place of log c_p among a joint's own parameters
SHARED_MOVES = 3  # of (μ, φ) in a sweep: they move least
RECENTRES = 3  # times that the model is linearised anew while the chains settle
NOISE_WEIGHT = 2.0 / NOISE_VARIANCE_SD**2  # numbers that the noise's estimate is worth
DISPERSION = 2.0  # of the starts, in posterior standard deviations

Progress = Callable[[Iterable, str], Iterable]


class Size(NamedTuple):
    """How much is drawn."""

    chains: int
    tune: int
    draws: int


@dataclass(eq=False)
class State:
    """Where the chains stand.

    own (chain, trial, d); shared (chain, d + p) of μ and φ; variance (chain, d); scale (chain,),
    s²; chi_square (chain, trial) of the full model at s = 1.
    """

    own: NDArray[np.float64]
    shared: NDArray[np.float64]
    variance: NDArray[np.float64]
    scale: NDArray[np.float64]
    chi_square: NDArray[np.float64]


def sample_effects(
    problem: Problem,
    candidate: Candidate,
    size: Size,
    rng: np.random.Generator,
    progress: Progress = track_progress,
) -> tuple[dict[str, NDArray[np.float64]], NDArray[np.float64]]:
    """Sample the posterior of a fitted model.

    Parameters
    ----------
    candidate
        The model and its fit, where the linearised model is taken.

    Returns
    -------
    draws
        mean (chain, draw, d), sd (chain, draw, d), effect (chain, draw, p), own (chain, draw,
        trial, d), scale (chain, draw), the noise's sd over its estimate.
    acceptance
        (chain, draw) share of trials' proposals that were accepted.
    """
    sampler = Sampler(problem, candidate, rng)
    state = sampler.start(size.chains)
    kept: list[State] = []
    accepted = []
    again = {size.tune * part // RECENTRES for part in range(1, RECENTRES + 1)}
    for k in progress(range(size.tune + size.draws), "sampling the repaired model"):
        if k in again:
            sampler.recentre(kept)
            kept, accepted = [], []
        accepted.append(sampler.sweep(state))
        kept.append(State(*(a.copy() for a in vars(state).values())))
    d = sampler.d

    def gather(name: str) -> NDArray:
        return np.stack([getattr(s, name) for s in kept], axis=1)

    shared = gather("shared")
    draws = {
        "mean": shared[..., :d],
        "sd": np.sqrt(gather("variance")),
        "effect": shared[..., d:],
        "own": gather("own"),
        "scale": np.sqrt(gather("scale")),
    }
    return draws, np.stack(accepted, axis=1)


class Sampler:
    """The moves of `sample_effects`."""

    def __init__(self, problem: Problem, candidate: Candidate, rng: np.random.Generator) -> None:
        self.problem, self.model, self.fit, self.rng = problem, candidate.model, candidate.fit, rng
        self.prior = problem.build_prior(candidate.model)
        self.d, self.p = len(self.fit.omega), len(self.fit.shared)
        self.rows = problem.trials.rows

    def start(self, chains: int) -> State:
        """Disperse the chains about the fit."""
        fit, rng = self.fit, self.rng
        both = np.concatenate([fit.mean, fit.shared])
        width = np.sqrt(np.concatenate([np.diag(fit.mean_covariance),
                                        np.diag(fit.shared_covariance)]))  # fmt: skip
        spread = np.sqrt(np.einsum("tii->ti", fit.own_covariance))
        while True:
            shared = both + DISPERSION * width * rng.standard_normal((chains, self.d + self.p))
            shared[:, self.d :] = np.clip(shared[:, self.d :], self.model.low, self.model.high)
            own = fit.own + spread * rng.standard_normal((chains, *fit.own.shape))
            chi_square = self.measure(own, shared[:, self.d :])
            if np.isfinite(chi_square).all():
                break
            width = width / 2
        variance = np.tile(np.diag(fit.omega), (chains, 1))
        return State(own, shared, variance, np.ones(chains), chi_square)

    def recentre(self, states: list[State]) -> None:
        """Linearise anew where the chains have been on average; only before draws are kept."""
        own = np.mean([state.own for state in states], axis=(0, 1))
        effect = np.mean([state.shared[:, self.d :] for state in states], axis=(0, 1))
        gram = self.problem.linearise(self.model, own, effect)
        if np.isfinite(gram).all():
            self.fit = self.fit._replace(own=own, shared=effect, gram=gram)

    def sweep(self, state: State) -> NDArray[np.float64]:
        """Move everything once; the share of trials (chain,) whose proposal was accepted."""
        linear = [self.linearise(v, s) for v, s in zip(state.variance, state.scale, strict=True)]
        for _ in range(SHARED_MOVES):
            self.move_shared(state, linear)
        share = self.move_own(state, linear)
        self.move_population(state)
        return share

    def linearise(self, variance: NDArray, scale: float) -> "Linear":
        """Solve the linearised model for given σ² and s²."""
        fit = self.fit
        gram = fit.gram / scale
        moved, near, centre = centre_gram(gram, self.prior, fit.own, fit.shared)
        solved = hold_omega(moved, near, np.diag(variance))
        kept = np.linalg.inv(gram[:, : self.d, : self.d] + np.diag(1.0 / variance))
        return Linear(
            solved.shared + centre,
            np.linalg.cholesky(solved.shared_covariance),
            kept,
            np.linalg.cholesky(kept),
        )

    def move_shared(self, state: State, linear: list["Linear"]) -> None:
        """Move (μ, φ) of each chain; η follows."""
        reach, walks = self.rng.choice(REACHES), bool(self.rng.integers(2))
        shared, own = state.shared.copy(), state.own.copy()
        for c, lin in enumerate(linear):
            step = reach * lin.root @ self.rng.standard_normal(self.d + self.p)
            if walks:
                shared[c] += step
            else:
                away = state.shared[c] - lin.mean
                shared[c] = lin.mean + np.sqrt(1 - reach**2) * away + step
            shift = self.expect(state, c, lin, shared[c])
            shift -= self.expect(state, c, lin, state.shared[c])
            own[c] = self.follow(own[c], shift) if walks else own[c] + shift
        effect = shared[:, self.d :]
        inside = ((effect >= self.model.low) & (effect <= self.model.high)).all(axis=1)
        inside &= np.isfinite(own).all(axis=(1, 2))
        own = np.where(inside[:, None, None], own, state.own)
        effect = np.where(inside[:, None], effect, state.shared[:, self.d :])
        chi_square = self.measure(own, effect)
        measure = self.weigh if walks else self.exceed
        now = measure(state, state.own, state.shared, state.chi_square).sum(axis=1)
        log_ratio = -0.5 * (measure(state, own, shared, chi_square).sum(axis=1) - now)
        if walks:
            centre, precision = self.prior.mean, self.prior.precision
            log_ratio += 0.5 * np.sum(precision * (state.shared - centre) ** 2, axis=1)
            log_ratio -= 0.5 * np.sum(precision * (shared - centre) ** 2, axis=1)
            log_ratio += (own - state.own)[..., FLOW::OWN].sum(axis=(1, 2))  # of `follow`
        taken = inside & (np.log(self.rng.uniform(size=len(linear))) < log_ratio)
        state.shared[taken], state.own[taken] = shared[taken], own[taken]
        state.chi_square[taken] = chi_square[taken]

    def follow(self, own: NDArray, shift: NDArray) -> NDArray[np.float64]:
        """Shift η (trial, d), its log c_p along 1/c_p, in which the model is linear; NaN beyond 0.

        The volume changes by c_p after over c_p before.
        """
        followed = own + shift
        flow = np.exp(-own[:, FLOW::OWN])
        flow = flow - np.exp(-self.fit.own[:, FLOW::OWN]) * shift[:, FLOW::OWN]
        with np.errstate(invalid="ignore", divide="ignore"):
            followed[:, FLOW::OWN] = -np.log(np.where(flow > 0, flow, np.nan))
        return followed

    def move_own(self, state: State, linear: list["Linear"]) -> NDArray[np.float64]:
        """Move η of every trial by itself."""
        reach = self.rng.choice(REACHES, (*state.chi_square.shape, 1))
        walks = bool(self.rng.integers(2))
        kept = np.ones_like(reach) if walks else np.sqrt(1 - reach**2)
        own = np.empty_like(state.own)
        for c, lin in enumerate(linear):
            middle = self.expect(state, c, lin, state.shared[c])
            normal = self.rng.standard_normal(middle.shape)
            step = np.einsum("tab,tb->ta", lin.own_root, normal)
            own[c] = middle + kept[c] * (state.own[c] - middle) + reach[c] * step
        chi_square = self.measure(own, state.shared[:, self.d :])
        measure = self.weigh if walks else self.exceed
        now = measure(state, state.own, state.shared, state.chi_square)
        log_ratio = -0.5 * (measure(state, own, state.shared, chi_square) - now)
        taken = np.log(self.rng.uniform(size=log_ratio.shape)) < log_ratio
        state.own[taken], state.chi_square[taken] = own[taken], chi_square[taken]
        return taken.mean(axis=1)

    def move_population(self, state: State) -> None:
        """Draw μ, σ² and s² from their exact conditionals."""
        rng, d, prior, n = self.rng, self.d, self.prior, state.own.shape[1]
        precision = prior.precision[:d] + n / state.variance
        middle = prior.precision[:d] * prior.mean[:d] + state.own.sum(axis=1) / state.variance
        normal = rng.standard_normal(precision.shape)
        state.shared[:, :d] = middle / precision + normal / np.sqrt(precision)
        away = np.sum((state.own - state.shared[:, None, :d]) ** 2, axis=1)
        total = prior.weight * prior.spread**2 + away
        state.variance[:] = total / rng.chisquare(prior.weight + n, total.shape)
        squares = NOISE_WEIGHT + state.chi_square.sum(axis=1)
        state.scale[:] = squares / rng.chisquare(NOISE_WEIGHT + self.rows, len(squares))

    def expect(self, state: State, chain: int, lin: "Linear", shared: NDArray) -> NDArray:
        """Mean of η (trial, d) given (μ, φ) in the linearised model."""
        d, fit = self.d, self.fit
        pull = fit.gram[:, :d, -1] - fit.gram[:, :d, d:-1] @ (shared[d:] - fit.shared)
        pull = pull / state.scale[chain] + (shared[:d] - fit.own) / state.variance[chain]
        return fit.own + np.einsum("tab,tb->ta", lin.own_covariance, pull)

    def weigh(
        self, state: State, own: NDArray, shared: NDArray, chi_square: NDArray
    ) -> NDArray[np.float64]:
        """−2 log of the density of recordings and η (chain, trial), but for constants."""
        away = (own - shared[:, None, : self.d]) ** 2 / state.variance[:, None]
        return chi_square / state.scale[:, None] + away.sum(axis=2)

    def exceed(
        self, state: State, own: NDArray, shared: NDArray, chi_square: NDArray
    ) -> NDArray[np.float64]:
        """χ² of the full model over that of the linearised one (chain, trial)."""
        fit = self.fit
        away = np.empty((*own.shape[:2], fit.gram.shape[1]))
        away[..., : self.d] = fit.own - own
        away[..., self.d : -1] = (fit.shared - shared[:, self.d :])[:, None]
        away[..., -1] = 1.0
        excess = chi_square - np.einsum("cta,tab,ctb->ct", away, fit.gram, away)
        return excess / state.scale[:, None]

    def measure(self, own: NDArray, effect: NDArray) -> NDArray[np.float64]:
        """χ² (chain, trial) of the full model at s = 1; infinite where it cannot be integrated."""
        return measure_chains(self.problem, Candidate(self.model, self.fit, 0.0), own, effect)


class Linear(NamedTuple):
    """The linearised model for given σ² and s².

    mean (d + p,) and root (d + p, d + p) of (μ, φ); own_covariance and own_root (trial, d, d) of η
    given them.
    """

    mean: NDArray[np.float64]
    root: NDArray[np.float64]
    own_covariance: NDArray[np.float64]
    own_root: NDArray[np.float64]
