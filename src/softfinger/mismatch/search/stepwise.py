"""Search for effects that act together.

Forward addition, backward elimination, every model kept. What one effect leaves may be the error
of its textbook form. So a further effect has a free-form term on top of the effects before as its
rival. It is believed where its few numbers gain more than a spline in time, load or angle does.
"""

from collections.abc import Iterable
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from softfinger.inference.problem import Candidate, Problem
from softfinger.mechanics.effects.model import Piece
from softfinger.mismatch.budget import BUDGET
from softfinger.mismatch.candidates.columns import ScoreColumns, collect_columns
from softfinger.mismatch.candidates.elsewhere import list_compatible, list_elsewhere
from softfinger.mismatch.candidates.other_forms import find_other_form, keep_leading, swap_forms
from softfinger.mismatch.candidates.pairs import rank_pairs
from softfinger.mismatch.candidates.rank import (
    Progress,
    Score,
    competing_nats,
    find_best,
    prune,
    rank_pieces,
)
from softfinger.mismatch.decisions import DECISIONS
from softfinger.mismatch.search.shape import Shape, allow_rest, excels, measure_shape


class Search(NamedTuple):
    """Everything that was fitted.

    Attributes
    ----------
    base
        The base model.
    candidates
        The models that compete, best first: those of no more effects than were accepted.
    rejected
        Models with one effect more, which gained no more than chance does.
    best
        The set that addition and elimination end with.
    first_gain
        Largest gain of one effect over the base model [nats].
    refused
        Effect id → why the campaign cannot show it.
    scores
        One-step scores of every form over the base model.
    shape
        The last free-form term that was fitted on top of effects.
    alone
        The best free-form term on top of the base model.
    """

    base: Candidate
    candidates: list[Candidate]
    rejected: list[Candidate]
    best: Candidate
    first_gain: float
    refused: dict[str, str]
    scores: list[Score]
    shape: Shape | None = None
    alone: Shape | None = None


def search_effects(
    problem: Problem,
    base: Candidate,
    catalogue: tuple[list[Piece], dict[str, str]],
    columns: ScoreColumns,
    needed: float,
    progress: Progress,
    ranked: tuple[list[Candidate], list[Score]],
) -> Search:
    """Add effects while one gains `needed` nats, then eliminate.

    Parameters
    ----------
    catalogue
        Every form that the campaign allows, and why it refuses the other effects.
    columns
        Of the catalogue, on top of the base model.
    needed
        Gain [nats] that chance exceeds in 1 % of campaigns, over the whole catalogue.
    ranked
        What `rank_pieces` gives for the catalogue on top of the base model.
    """
    pieces, refused = catalogue
    singles, scores = ranked
    found, larger, shape, alone = list(singles), [], None, None
    best = _choose_top(singles, base)
    first_gain = best.log_evidence - base.log_evidence
    if first_gain <= needed:
        return Search(base, found, [], base, max(first_gain, 0.0), refused, scores)
    for size in range(2, BUDGET.most_effects + 1):
        larger = []
        explained = best.log_evidence - base.log_evidence
        if len(best.model.ids - base.model.ids) == BUDGET.most_effects - 1:
            # a last effect that gains more than this is too much for two to leave: unlisted
            most = allow_rest(explained, needed)
            shape, alone = measure_shape(problem, best), measure_shape(problem, base)
            if shape.gain > most or excels(alone, explained + most):
                break
        more = require_gain(needed, explained, pieces, best)
        asked = best.log_evidence + more
        rivals = _list_rivals(base, found, len(best.model.ids))
        larger = _enlarge(problem, rivals, best, found, pieces, progress, asked, size)
        if size == 2:
            larger += rank_pairs(problem, base, columns, larger, asked, progress)
        top = _choose_top(larger, best)
        gain = top.log_evidence - best.log_evidence
        if gain <= more:
            break
        if shape is None or shape.fit is not best.fit:
            shape = measure_shape(problem, best)
        if gain <= shape.gain:
            break
        found += larger
        larger = []
        found += swap_forms(problem, top, pieces)
        if size == 2:
            tried = {rival.model.ids for rival in rivals}
            found += _try_partners(problem, top, tried, pieces, progress)
        best = _eliminate(problem, _choose_top([top, *found], top), more, found)
    found.sort(key=lambda c: -c.log_evidence)
    return Search(base, found, larger, best, first_gain, refused, scores, shape, alone)


def _choose_top(candidates: list[Candidate], other: Candidate) -> Candidate:
    """The fit of most evidence, or else the other."""
    fitted = [c for c in candidates if c.fit is not None]
    return max(fitted, key=lambda c: c.log_evidence, default=other)


def require_gain(needed: float, explained: float, pieces: list[Piece], best: Candidate) -> float:
    """Gain [nats] that a further effect must bring.

    As much as a first one, and what it costs that there are so many more pairs than effects. Where
    an effect before has no free law, also more than the error that its textbook forms may have.
    """
    effects = len({piece.effect.id for piece in pieces})
    more = needed + float(np.log(max(effects, 1)))
    free = {piece.effect.id for piece in pieces if piece.form.is_free}
    if best.model.ids <= free:
        return more
    return more + DECISIONS.form_error * max(explained, 0.0)


def shape_rest(problem: Problem, search: Search) -> Search:
    """Have the best model's free-form term, fitted once."""
    if search.shape is not None and search.shape.fit is search.best.fit:
        return search
    return search._replace(shape=measure_shape(problem, search.best))


def hold_against_shape(problem: Problem, search: Search) -> Search:
    """Compare the effects with a free-form term alone.

    A term with which they do not compete shows something else, which they only imitate. It then
    takes their place. Where the evidence is large, any spline gains a little more than they do,
    for no recording has the textbook form.
    """
    if search.best is search.base:
        return search
    alone = search.alone or measure_shape(problem, search.base)
    if excels(alone, search.best.log_evidence - search.base.log_evidence):
        return search._replace(best=search.base, shape=alone, alone=alone)
    return search._replace(alone=alone)


def _list_rivals(base: Candidate, found: list[Candidate], size: int) -> list[Candidate]:
    """Best models of the closest sets, of one size."""
    best: dict[frozenset[str], Candidate] = {}
    for candidate in sorted(found, key=lambda c: -c.log_evidence):
        if candidate.fit is not None and len(candidate.model.ids) == size:
            best.setdefault(candidate.model.ids, candidate)
    rivals = list(best.values())[: BUDGET.rivals]
    leading = rivals[0].log_evidence
    behind = competing_nats(leading - base.log_evidence)
    return [c for c in rivals if c.log_evidence > leading - behind]


def _can_lead(rival: Candidate, best: Candidate, larger: list[Candidate]) -> bool:
    """Whether one more effect could let a set lead."""
    behind = best.log_evidence - rival.log_evidence
    return behind <= max(find_best(larger) - best.log_evidence, DECISIONS.rival_nats)


def _enlarge(
    problem: Problem,
    rivals: list[Candidate],
    best: Candidate,
    found: list[Candidate],
    pieces: list[Piece],
    progress: Progress,
    asked: float,
    size: int,
) -> list[Candidate]:
    """Rank one more effect on sets that may lead.

    For `size` 2 that is every set. With the other form of the best, only what leads is tried.
    """
    larger: list[Candidate] = []
    for rival in rivals:
        if size == 2 or _can_lead(rival, best, larger):
            larger += _extend(problem, rival, pieces, progress, max(asked, find_best(larger)))
    other = find_other_form(found, best)
    if other is not None and (size == 2 or _can_lead(other, best, larger)):
        leading = keep_leading(pieces, larger, best)
        larger += _extend(problem, other, leading, progress, max(asked, find_best(larger)))
    return larger


def _extend(
    problem: Problem,
    rival: Candidate,
    pieces: Iterable[Piece],
    progress: Progress,
    floor: float,
) -> list[Candidate]:
    """Rank every further effect; `floor` as in `fit_scored`."""
    more = list_compatible(rival, list_elsewhere(problem, rival.model, pieces))
    columns = collect_columns(problem, rival, progress(more, "trying effects"))
    return rank_pieces(problem, rival, columns, progress, floor)[0]


def _try_partners(
    problem: Problem,
    pair: Candidate,
    tried: set[frozenset[str]],
    pieces: list[Piece],
    progress: Progress,
) -> list[Candidate]:
    """Rank every partner of either effect of a pair.

    Those `tried` with all others are left out. One that gains little alone is met
    through the other only, which need not be its true partner
    (floating search: Pudil, Novovičová and Kittler 1994, Pattern Recognit. Lett. 15, 1119).
    """
    found = []
    for piece in _list_added(problem, pair):
        if pair.model.ids - {piece.effect.id} in tried:
            continue
        alone = _fit_without(problem, pair, piece)
        if alone is not None:
            found += _extend(problem, alone, pieces, progress, pair.log_evidence)
    return found


def _list_added(problem: Problem, candidate: Candidate) -> list[Piece]:
    return [p for p in candidate.model.pieces if p.effect.id not in problem.base.ids]


def _fit_without(problem: Problem, candidate: Candidate, piece: Piece) -> Candidate | None:
    """Fit a model without a piece, else None."""
    kept = tuple(p for p in candidate.model.pieces if p is not piece)
    model = replace(candidate.model, pieces=kept)
    shared = candidate.fit.shared[candidate.model.match(model)]
    start = candidate.fit.own, shared, candidate.fit.omega
    fit = problem.fit(model, start, first=candidate.fit.first)
    if fit is None or not fit.converged:
        return None
    return prune(problem, Candidate(model, fit, fit.log_evidence))


def _eliminate(
    problem: Problem, candidate: Candidate, needed: float, found: list[Candidate]
) -> Candidate:
    """Drop effects that cost less than `needed` nats."""
    while len(added := _list_added(problem, candidate)) > 1:
        fits = (_fit_without(problem, candidate, piece) for piece in added)
        smaller = [c for c in fits if c is not None]
        found += smaller
        top = max(smaller, key=lambda c: c.log_evidence, default=None)
        if top is None or candidate.log_evidence - top.log_evidence > needed:
            return candidate
        candidate = top
    return candidate
