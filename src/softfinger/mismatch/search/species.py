"""What a free law is: the effect whose textbook forms come nearest.

Effects of one place and one argument share their free law: a spectrum of retardation times is a
second retardation where it has one peak, a power law where it is broad. Nature's law departs from
every textbook. With a departure of unknown size σ along n terms, prior ∝ 1/σ, an effect whose best
textbook form loses D nats against the free law has the probability

    p ∝ ∫ σ^{−n} e^{−D/σ²} dσ/σ ∝ D^{−n/2}, and (1 + D)^{−n/2} as no loss is known to a nat.
"""

from dataclasses import replace
from typing import NamedTuple

import numpy as np

from softfinger.inference.problem import Candidate, Problem
from softfinger.mechanics.effects import list_effects
from softfinger.mechanics.effects.effect import Effect, Form
from softfinger.mechanics.effects.model import EffectModel, Piece
from softfinger.mismatch.budget import BUDGET
from softfinger.mismatch.candidates.other_forms import list_starts_beside
from softfinger.mismatch.candidates.rank import find_best, go_on
from softfinger.mismatch.search.stepwise import Search


class Kin(NamedTuple):
    """An effect that shares a free law with others: its free forms by name, and its textbook's."""

    effect: Effect
    free: dict[str, Form]
    textbook: list[Form]


def name_species(problem: Problem, search: Search) -> Search:
    """Share a free law's evidence among the effects that it may be."""
    model = search.best.model
    at = next((k for k, p in enumerate(model.pieces) if _is_open(problem, p)), None)
    if at is None:
        return search
    kin = list_kin(problem, model.pieces[at].form)
    loss = np.array([_measure_loss(problem, search, at, one) for one in kin])
    terms = len(model.pieces[at].form.parameters) * max(len(model.pieces[at].places), 1)
    share = weigh_species(loss, terms)
    old = model.pieces[at]
    candidates = []
    for candidate in search.candidates:
        mine = [k for k, p in enumerate(candidate.model.pieces) if p.form.kin == old.form.kin]
        if not mine or candidate.model.ids != model.ids:
            candidates.append(candidate)
            continue
        candidates += [
            _rename(candidate, mine[0], one, p) for one, p in zip(kin, share, strict=True)
        ]
    best = _rename(search.best, at, kin[int(share.argmax())], share.max())
    candidates.sort(key=lambda c: -c.log_evidence)
    return search._replace(candidates=candidates, best=best)


def weigh_species(loss: np.ndarray, terms: int) -> np.ndarray:
    """Probability of each species from what its textbook forms lose [nats].

    >>> weigh_species(np.array([90.0, 360.0]), 6).round(3)
    array([0.984, 0.016])
    """
    # infinite where no textbook form could be fitted
    known = np.clip(loss, 0.0, np.finfo(float).max)
    weight = -0.5 * terms * np.log1p(known)
    return np.exp(weight - np.logaddexp.reduce(weight))


def list_kin(problem: Problem, form: Form) -> list[Kin]:
    """List the effects that share a free law."""
    kin = []
    for effect in list_effects().values():
        forms = effect.list_forms(problem.setting)
        same = {} if isinstance(forms, str) else {f.name: f for f in forms if f.kin == form.kin}
        if same:
            kin.append(Kin(effect, same, [f for f in forms if not f.kin]))
    return kin


def _is_open(problem: Problem, piece: Piece) -> bool:
    return bool(piece.form.kin) and piece.effect.id not in problem.base.ids


def _rename(candidate: Candidate, at: int, one: Kin, share: float) -> Candidate:
    pieces = list(candidate.model.pieces)
    form = one.free[pieces[at].form.name]
    pieces[at] = replace(pieces[at], effect=one.effect, form=form)
    evidence = candidate.log_evidence + float(np.log(max(share, 1e-300)))
    model = replace(candidate.model, pieces=tuple(pieces))
    return candidate._replace(model=model, log_evidence=evidence)


def _measure_loss(problem: Problem, search: Search, at: int, one: Kin) -> float:
    """What the best textbook form loses [nats] against the free law."""
    best = search.best
    fits = [fit_in_place(problem, best, at, Piece(one.effect, form, best.model.pieces[at].places))
            for form in one.textbook]  # fmt: skip
    return best.log_evidence - find_best(c for c in fits if c is not None)


def fit_in_place(problem: Problem, best: Candidate, at: int, piece: Piece) -> Candidate | None:
    """Fit a model with another form in one piece's place, from the best of its starts."""
    pieces = list(best.model.pieces)
    pieces[at] = piece
    model: EffectModel = replace(best.model, pieces=tuple(pieces))
    begun = []
    for shared in list_starts_beside(best, model, at):
        start = best.fit.own, shared, best.fit.omega
        fit = problem.fit(model, start, steps=BUDGET.first_steps, first=best.fit.first)
        begun += [] if fit is None else [fit]
    if not begun:
        return None
    fit = go_on(problem, model, max(begun, key=lambda f: f.log_evidence))
    return None if fit is None else Candidate(model, fit, fit.log_evidence)
