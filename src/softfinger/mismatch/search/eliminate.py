"""Take effects back that a set does not need."""

from dataclasses import replace

from softfinger.inference.problem import Candidate, Problem
from softfinger.mechanics.effects.model import Piece
from softfinger.mismatch.candidates.rank import prune


def choose_top(candidates: list[Candidate], other: Candidate) -> Candidate:
    """The fit of most evidence, or else the other."""
    fitted = [c for c in candidates if c.fit is not None]
    return max(fitted, key=lambda c: c.log_evidence, default=other)


def list_added(problem: Problem, candidate: Candidate) -> list[Piece]:
    """List a model's pieces beyond those of the base."""
    return [p for p in candidate.model.pieces if p.effect.id not in problem.base.ids]


def fit_without(problem: Problem, candidate: Candidate, piece: Piece) -> Candidate | None:
    """Fit a model without a piece, else None."""
    return _fit_kept(problem, candidate, [p for p in candidate.model.pieces if p is not piece])


def fit_less(problem: Problem, candidate: Candidate, ids: frozenset[str]) -> Candidate | None:
    """Fit a model without some effects, else None."""
    kept = [p for p in candidate.model.pieces if p.effect.id not in ids]
    return _fit_kept(problem, candidate, kept)


def _fit_kept(problem: Problem, candidate: Candidate, kept: list[Piece]) -> Candidate | None:
    model = replace(candidate.model, pieces=tuple(kept))
    shared = candidate.fit.shared[candidate.model.match(model)]
    start = candidate.fit.own, shared, candidate.fit.omega
    fit = problem.fit(model, start, first=candidate.fit.first)
    if fit is None:
        return None
    return prune(problem, Candidate(model, fit, fit.log_evidence))


def eliminate(
    problem: Problem, candidate: Candidate, needed: float, found: list[Candidate]
) -> Candidate:
    """Drop effects that cost less than `needed` nats."""
    while len(added := list_added(problem, candidate)) > 1:
        fits = (fit_without(problem, candidate, piece) for piece in added)
        smaller = [c for c in fits if c is not None]
        found += smaller
        top = max(smaller, key=lambda c: c.log_evidence, default=None)
        if top is None or candidate.log_evidence - top.log_evidence > needed:
            return candidate
        candidate = top
    return candidate
