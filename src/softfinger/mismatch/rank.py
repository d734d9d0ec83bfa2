"""Every effect in every form, ranked by evidence.

A form is scored by one linearisation from each of its starts; the promising ones are fitted, from
the best start, and freed of joints that they do not need.
"""

from collections.abc import Iterable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from softfinger.mechanics.effects import list_effects
from softfinger.mechanics.effects.effect import Setting
from softfinger.mechanics.effects.model import EffectModel, Piece
from softfinger.mismatch.problem import Problem
from softfinger.population.mixed_effects_laplace import Fit, solve_linearised

FIRST_STEPS = 4  # linearisations before candidates are compared
REACH, REACH_SHARE = 20.0, 0.5  # nats, or share of the best gain, within which a fit goes on
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


def prune(problem: Problem, candidate: Candidate) -> Candidate:
    """Drop places that the fitted model does not need, and fit what is left."""
    fit = candidate.fit
    there = Linearised(fit.gram, fit.own, fit.shared, fit.omega)
    model, _ = drop_places(problem, candidate.model, there, rounds=5)
    if model is candidate.model:
        return candidate
    refit = problem.fit(model, (fit.own, fit.shared[candidate.model.match(model)], fit.omega))
    if refit is None or not refit.converged or refit.log_evidence < candidate.log_evidence:
        return candidate
    return Candidate(model, refit, refit.log_evidence)


def rank_pieces(
    problem: Problem, origin: Candidate, pieces: Iterable[Piece]
) -> tuple[list[Candidate], list[Score]]:
    """Fit every promising piece on top of a fitted model, best first; and all scores.

    Each gets a few linearisations; those that then stand within reach of the best go on until they
    come to rest. One that does not come to rest is missing, not evidence against it.
    """
    scores = [score_piece(problem, origin, piece) for piece in pieces]
    scores = sorted((s for s in scores if s is not None), key=lambda s: -s.gain)
    candidates = [
        Candidate(s.model, None, origin.log_evidence + s.gain) for s in scores if s.gain < HOPELESS
    ]
    begun = []
    for score in scores[: len(scores) - len(candidates)]:
        start = origin.fit.own, score.shared, origin.fit.omega
        fit = problem.fit(score.model, start, steps=FIRST_STEPS)
        if fit is not None:
            begun.append((score.model, fit))
    best = max((fit.log_evidence for _, fit in begun), default=origin.log_evidence)
    reach = max(REACH, REACH_SHARE * (best - origin.log_evidence))
    for model, fit in begun:
        if fit.log_evidence < best - reach:
            candidates.append(Candidate(model, None, fit.log_evidence))
            continue
        if not fit.converged:
            fit = problem.fit(model, (fit.own, fit.shared, fit.omega))
        if fit is not None and fit.converged:
            candidates.append(prune(problem, Candidate(model, fit, fit.log_evidence)))
    return sorted(candidates, key=lambda c: -c.log_evidence), scores
