"""Other forms of the effects that were found.

The form that fits best alone may replace an effect that is still missing: a lag of two stages takes
the place of the links' mass, and leaves no room for it. So a further effect is tried beside another
form too, and a set that was found is tried in its other forms, from where it was found.
"""

from collections.abc import Iterable, Iterator
from dataclasses import replace
from functools import partial

import numpy as np
from numpy.typing import NDArray

from softfinger.inference.problem import Candidate, Problem
from softfinger.mechanics.effects.model import EffectModel, Piece
from softfinger.mismatch.budget import BUDGET
from softfinger.mismatch.candidates.law_size import resize_laws
from softfinger.mismatch.candidates.linearised import place_fit
from softfinger.mismatch.candidates.rank import Progress, go_on, prune

Start = tuple[EffectModel, NDArray[np.float64]]


def find_other_form(found: Iterable[Candidate], best: Candidate) -> Candidate | None:
    """Find the best fit of one effect's other form."""
    others = [
        c
        for c in found
        if c.fit is not None
        and c.model.ids == best.model.ids
        and _name_forms(c.model) != _name_forms(best.model)
    ]
    return max(others, key=lambda c: c.log_evidence, default=None)


def keep_leading(pieces: Iterable[Piece], larger: list[Candidate], best: Candidate) -> list[Piece]:
    """Keep the forms of effects that gained most."""
    leading: dict[str, None] = {}
    for candidate in sorted(larger, key=lambda c: -c.log_evidence):
        if best.model.ids < candidate.model.ids:
            leading |= dict.fromkeys(candidate.model.ids - best.model.ids)
    chosen = set(list(leading)[: BUDGET.leading])
    return [piece for piece in pieces if piece.effect.id in chosen]


def list_finer(candidate: Candidate, pieces: Iterable[Piece]) -> list[Piece]:
    """List the finer laws of a model's effects, where they act.

    A textbook form may lead an effect's free law, and yet leave what the finer one explains.
    """
    finer = {}
    for one in pieces:
        for mine in candidate.model.pieces:
            alike = one.effect.id == mine.effect.id and bool(one.places) == bool(mine.places)
            if alike and one.form.finer is not None:
                new = replace(one, form=one.form.finer, places=mine.places, size=mine.size)
                finer[one.effect.id, one.form.name] = new
    return list(finer.values())


def swap_forms(
    problem: Problem,
    candidate: Candidate,
    pieces: list[Piece],
    progress: Progress = lambda items, _: items,
) -> list[Candidate]:
    """Fit a model with one effect's form swapped.

    It is repeated while that gains.

    Parameters
    ----------
    progress
        Wraps each round, and may end it early.

    Returns
    -------
    list of Candidate
        Models that came to rest, round by round, each round's best last; empty where none gains.
    """
    fitted: list[Candidate] = []
    while True:
        best = fitted[-1] if fitted else candidate
        swaps = progress(list(_list_swaps(best, pieces)), "trying other forms")
        fits = (_fit_near(problem, best, start) for start in swaps)
        swapped = [c for c in fits if c is not None]
        top = max(swapped, key=lambda c: c.log_evidence, default=best)
        if top.log_evidence <= best.log_evidence:
            return fitted
        fitted += [*(c for c in swapped if c is not top), top]


def _name_forms(model: EffectModel) -> dict[str, str]:
    return {piece.effect.id: piece.form.name for piece in model.pieces}


def _list_swaps(candidate: Candidate, pieces: list[Piece]) -> Iterator[Start]:
    """List models with one other form, by start."""
    for number, old in enumerate(candidate.model.pieces):
        for new in pieces:
            same = new.effect.id == old.effect.id and new.places == old.places
            if same and new.form.name != old.form.name:
                kept = list(candidate.model.pieces)
                kept[number] = replace(new, size=old.size)
                model = replace(candidate.model, pieces=tuple(kept))
                yield from (
                    (model, shared) for shared in list_starts_beside(candidate, model, number)
                )


def list_starts_beside(
    candidate: Candidate, model: EffectModel, number: int
) -> list[NDArray[np.float64]]:
    """List starts (p,) of a model of which one piece is new.

    The rest is as it was fitted.
    """
    known = dict(zip(_name_entries(candidate.model), candidate.fit.shared, strict=True))
    names = _name_entries(model)
    starts = {}
    for start in model.list_starts(number):
        fresh = [start.get(entry.parameter.name, 0.0) for entry in model.entries]
        values = [known.get(name, value) for name, value in zip(names, fresh, strict=True)]
        starts[tuple(values)] = np.clip(values, model.low, model.high)
    return list(starts.values())


def _name_entries(model: EffectModel) -> list[tuple[str, str]]:
    return [(model.pieces[entry.piece].effect.id, entry.name) for entry in model.entries]


def _fit_near(problem: Problem, best: Candidate, start: Start) -> Candidate | None:
    """Fit a model near the best, else None."""
    model, shared = start
    near = best.log_evidence - BUDGET.reach_nats
    begin = partial(problem.fit, steps=BUDGET.first_steps, first=best.fit.first, rival=near)
    fit = begin(model, (best.fit.own, shared, best.fit.omega))
    if fit is not None:
        sized = resize_laws(problem, model, place_fit(fit))
        if sized is not model:
            model = sized
            fit = begin(model, (fit.own, fit.shared, fit.omega))
    if fit is None or fit.log_evidence < near:
        return None
    fit = go_on(problem, model, fit)
    if fit is None:
        return None
    return prune(problem, Candidate(model, fit, fit.log_evidence))
