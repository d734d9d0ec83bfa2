"""Every effect in every form, ranked by evidence.

A form is scored by one linearisation from each of its starts; the promising ones are fitted, from
the best start, and freed of joints that they do not need.
"""

from collections.abc import Iterable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from softfinger.mechanics.effects import list_effects
from softfinger.mechanics.effects.effect import Effect, Setting
from softfinger.mismatch.model import EffectModel, Piece
from softfinger.mismatch.problem import Problem
from softfinger.population.mixed_effects_laplace import Fit, solve_linearised

HOPELESS = -2.0  # nats: forms whose linearised gain is lower are not fitted; their score counts


class Candidate(NamedTuple):
    """A model, its fit and its log evidence [nats]; `fit` is None where only its score is known."""

    model: EffectModel
    fit: Fit | None
    log_evidence: float


class Score(NamedTuple):
    """What one linearisation says of a model: gain [nats] from the best start, and that start."""

    model: EffectModel
    gain: float
    shared: NDArray[np.float64]


def list_pieces(setting: Setting) -> tuple[list[Piece], dict[str, str]]:
    """List every form that a campaign allows, and why the other effects cannot show.

    Returns
    -------
    pieces, refused
        `refused`: effect id → reason.
    """
    pieces, refused = [], {}
    for effect in list_effects().values():
        forms = effect.build_forms(setting)
        if isinstance(forms, str):
            refused[effect.id] = forms
            continue
        pieces += [Piece(effect, form, _places(form.parameters, setting)) for form in forms]
    return pieces, refused


def _places(parameters: Iterable, setting: Setting) -> tuple[tuple[int, ...], ...]:
    kinds = {parameter.per for parameter in parameters}
    joints = range(setting.joints)
    if "pair" in kinds:
        return tuple((j, k) for j in joints for k in (j - 1, j + 1) if 0 <= k < setting.joints)
    return tuple((j,) for j in joints) if "joint" in kinds else ()


def score_piece(problem: Problem, origin: Candidate, piece: Piece) -> Score | None:
    """Score one more piece: the best linearised gain over its starts; None if it has no motion.

    Places that the linearised model does not need are dropped.
    """
    model = origin.model.extend(piece)
    number = len(origin.model.pieces)
    best = None
    for start in model.list_starts(number):
        shared = np.concatenate([origin.fit.shared, model.place_start(number, start)])
        gram = problem.linearise(model, origin.fit.own, shared)
        if not np.isfinite(gram).all():
            continue
        there = Linearised(gram, origin.fit.own, shared, origin.fit.omega)
        smaller, evidence = drop_places(problem, model, there, rounds=0)
        gain = evidence - origin.log_evidence
        if best is None or gain > best.gain:
            best = Score(smaller, gain, shared[model.match(smaller)])
    return best


class Linearised(NamedTuple):
    """A model linearised at (η, φ): Gram matrices of [∂F/∂η | ∂F/∂φ | residual], and Ω."""

    gram: NDArray[np.float64]
    own: NDArray[np.float64]
    shared: NDArray[np.float64]
    omega: NDArray[np.float64]


def drop_places(
    problem: Problem, model: EffectModel, there: Linearised, *, rounds: int
) -> tuple[EffectModel, float]:
    """Drop places of the last piece one by one while the linearised evidence rises."""
    now, evidence = model, evaluate_without(problem, model, there, model, rounds)
    while True:
        last = len(now.pieces) - 1
        smaller = [
            now.without(e)
            for e in now.entries
            if e.parameter.amplitude and e.piece == last and len(now.pieces[last].places) > 1
        ]
        values = [evaluate_without(problem, model, there, other, rounds) for other in smaller]
        if not values or max(values) <= evidence:
            return now, evidence
        now, evidence = smaller[int(np.argmax(values))], max(values)


def evaluate_without(
    problem: Problem, model: EffectModel, there: Linearised, smaller: EffectModel, rounds: int
) -> float:
    """Log evidence of a model with fewer numbers in φ, linearised where the larger one is."""
    d = len(there.omega)
    kept = model.match(smaller)
    absent = np.setdiff1d(np.flatnonzero(model.amplitudes), kept)
    shift = np.eye(there.gram.shape[1])  # the residual without what the absent amplitudes add
    shift[d + absent, -1] = there.shared[absent]
    columns = np.concatenate([np.arange(d), d + kept, [len(shift) - 1]])
    gram = (shift.T @ there.gram @ shift)[:, columns[:, None], columns]
    _, evidence = solve_linearised(
        gram,
        problem.build_prior(smaller),
        problem.build_bounds(smaller),
        (there.own, there.shared[kept]),
        there.omega,
        rounds=rounds,
    )
    return evidence


def fit_score(problem: Problem, origin: Candidate, score: Score) -> Candidate | None:
    """Fit a scored model from its best start; None if it does not come to rest."""
    start = origin.fit.own, score.shared, origin.fit.omega
    fit = problem.fit(score.model, start)
    return Candidate(score.model, fit, fit.log_evidence) if fit.converged else None


def prune(problem: Problem, candidate: Candidate) -> Candidate:
    """Drop places that the fitted model does not need, and fit what is left."""
    fit = candidate.fit
    there = Linearised(fit.gram, fit.own, fit.shared, fit.omega)
    model, _ = drop_places(problem, candidate.model, there, rounds=5)
    if model is candidate.model:
        return candidate
    refit = problem.fit(model, (fit.own, fit.shared[candidate.model.match(model)], fit.omega))
    if not refit.converged or refit.log_evidence < candidate.log_evidence:
        return candidate
    return Candidate(model, refit, refit.log_evidence)


def rank_pieces(
    problem: Problem, origin: Candidate, pieces: Iterable[Piece]
) -> tuple[list[Candidate], list[Score]]:
    """Fit every promising piece on top of a fitted model, best first; and all scores."""
    scores = [score_piece(problem, origin, piece) for piece in pieces]
    scores = sorted((s for s in scores if s is not None), key=lambda s: -s.gain)
    candidates = []
    for score in scores:
        if score.gain < HOPELESS:
            candidates.append(Candidate(score.model, None, origin.log_evidence + score.gain))
            continue
        candidate = fit_score(problem, origin, score)
        if candidate is not None:
            candidates.append(prune(problem, candidate))
    return sorted(candidates, key=lambda c: -c.log_evidence), scores


def list_effect_ids(candidates: Iterable[Candidate]) -> list[str]:
    """Ids of the effects of some candidates, each once, in order."""
    return list(dict.fromkeys(id_ for c in candidates for id_ in sorted(c.model.ids)))


def find_effect(effect_id: str) -> Effect:
    """Find an effect by its id."""
    return list_effects()[effect_id]
