"""Laws of the rate where each trial has one load.

There the rate and the time since the load came are functions of one another, so that what a damper
does by its rate, creep does by its time. Creep that is linear may have any course in time, and a
course of its own in each trial; a law of the rate shows no other. So a law that fits better has no
evidence of its own: its set shares its evidence with that in which creep has its place. Which creep
that is, is weighed as the species of a free law are, by what the best fit of each loses.
"""

from dataclasses import replace

import numpy as np

from softfinger.inference.problem import Candidate, Problem
from softfinger.mechanics.effects import list_effects
from softfinger.mechanics.effects.effect import Effect, Form
from softfinger.mismatch.candidates.rank import find_best
from softfinger.mismatch.search.species import fit_in_place, weigh_species
from softfinger.mismatch.search.stepwise import Search


def share_with_creep(problem: Problem, search: Search) -> Search:
    """Share the evidence of a law of the rate with creep, where each trial has one load.

    It stays as it is where the best model has no such law.
    """
    at = _find_law(problem, search.best)
    if at is None:
        return search
    mine = [c for c in search.candidates if c.model.ids == search.best.model.ids]
    evidence = np.array([c.log_evidence for c in mine or [search.best]])
    level = float(np.logaddexp.reduce(evidence) - np.log(len(evidence)))
    rivals, terms = _fit_rivals(problem, search, at)
    if not rivals:
        return search
    top = max(search.best.log_evidence, find_best(rivals))
    shares = weigh_species(np.array([top - rival.log_evidence for rival in rivals]), terms)
    sharing = [
        rival._replace(log_evidence=level + float(np.log(max(share, 1e-300))))
        for rival, share in zip(rivals, shares, strict=True)
    ]
    taken = {rival.model.ids for rival in rivals}
    candidates = [*(c for c in search.candidates if c.model.ids not in taken), *sharing]
    candidates.sort(key=lambda c: -c.log_evidence)
    return search._replace(candidates=candidates)


def _find_law(problem: Problem, best: Candidate) -> int | None:
    """Place of a piece whose law is a course in time here."""
    known = problem.base.ids
    for k, piece in enumerate(best.model.pieces):
        shared = piece.effect.place_in_time
        if piece.effect.id not in known and piece.effect.find_place(problem.setting) == shared:
            return k
    return None


def _fit_rivals(problem: Problem, search: Search, at: int) -> tuple[list[Candidate], int]:
    """Best model with each effect of the law's place in its stead; terms of the place's law."""
    old = search.best.model.pieces[at]
    rivals, terms = [], 1
    for effect in list_effects().values():
        forms = effect.list_forms(problem.setting)
        if effect.place != old.effect.place_in_time or isinstance(forms, str):
            continue
        laws = [len(form.parameters) for form in forms if form.kin]
        terms = max([terms, *(count * max(len(old.places), 1) for count in laws)])
        fits = _find_fits(problem, search, at, effect, forms)
        if fits and np.isfinite(find_best(fits)):
            rivals.append(max(fits, key=lambda c: c.log_evidence))
    return rivals, terms


def _find_fits(
    problem: Problem, search: Search, at: int, effect: Effect, forms: list[Form]
) -> list[Candidate]:
    """Fits of an effect in the law's stead: those of the search, else of all its forms."""
    best = search.best
    old = best.model.pieces[at]
    ids = best.model.ids - {old.effect.id} | {effect.id}
    known = [c for c in (*search.candidates, *search.rejected) if c.model.ids == ids]
    fitted = [c for c in known if c.fit is not None]
    if fitted:
        return fitted
    pieces = (replace(old, effect=effect, form=form) for form in forms)
    tried = (fit_in_place(problem, best, at, piece) for piece in pieces)
    return [c for c in tried if c is not None]
