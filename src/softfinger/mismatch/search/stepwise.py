"""Search for effects that act together.

Forward addition, backward elimination, every model kept. What one effect leaves may be the error
of its textbook form. So a further effect has a free-form term on top of the effects before as its
rival. It is believed where its few numbers gain more than a spline in time, load or angle does.
"""

from typing import NamedTuple

from softfinger.inference.problem import Candidate, Problem
from softfinger.mechanics.effects.model import Piece
from softfinger.mismatch.budget import BUDGET
from softfinger.mismatch.candidates.other_forms import (
    find_other_form,
    keep_leading,
    list_finer,
    swap_forms,
)
from softfinger.mismatch.candidates.pairs import rank_pairs
from softfinger.mismatch.candidates.rank import (
    Score,
    competing_nats,
    find_best,
)
from softfinger.mismatch.decisions import DECISIONS
from softfinger.mismatch.search.demand import build_demand, list_free
from softfinger.mismatch.search.eliminate import choose_top, eliminate
from softfinger.mismatch.search.extend import Task, extend, try_partners
from softfinger.mismatch.search.finer import fit_finer
from softfinger.mismatch.search.hidden import seek_hidden
from softfinger.mismatch.search.leading_pairs import fit_leading_pairs
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
    beyond
        Under `unlisted`: sets of more effects than the best, of which none is named.
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
    beyond: tuple[Candidate, ...] = ()


def search_effects(task: Task, needed: float, worth: float = 0.0) -> Search:
    """Add effects while one gains `needed` nats, then eliminate.

    Parameters
    ----------
    needed
        Gain [nats] that chance seldom exceeds, over the whole catalogue. Where one
        effect gains far more and leaves what a spline finds, linear scores of pairs err: those of
        the leading effects are fitted whatever their score.
    worth
        Gain [nats] that is worth reaching: nothing is added to a pair below it.
    """
    problem, base = task.problem, task.base
    found, larger, shape, alone = list(task.singles), [], None, None
    first_gain = (best := choose_top(found, base)).log_evidence - base.log_evidence
    if first_gain <= needed:
        none = Search(base, found, [], base, max(first_gain, 0.0), task.refused, task.scores)
        return _seek_hidden(task, none, max(needed, worth))
    for size in range(2, BUDGET.most_effects + 1):
        explained = best.log_evidence - base.log_evidence
        if len(best.model.ids - base.model.ids) == BUDGET.most_effects - 1:
            # a last effect that gains more than this is too much for two to leave: unlisted
            most = allow_rest(explained, needed)
            shape, alone = measure_shape(problem, best), measure_shape(problem, base)
            if shape.gain > most or excels(alone, explained + most):
                break
        more = require_gain(needed, explained, task.pieces, best)
        asked = max(best.log_evidence + more, base.log_evidence + worth)
        rivals = _list_rivals(base, found, len(best.model.ids))
        shape = measure_shape(problem, best) if size == 2 else shape
        larger = _enlarge(task, _Round(size, best, found, rivals, needed, more, asked, shape))
        top = choose_top(larger, best)
        if top.log_evidence - best.log_evidence > more:
            best = _face_finer(task, top, best, found, larger, more)
            top = choose_top(larger, best)
        gain = top.log_evidence - best.log_evidence
        if gain > more and (shape is None or shape.fit is not best.fit):
            shape = measure_shape(problem, best)
        if gain <= more or gain <= shape.gain:
            break
        found, larger = [*found, *larger], []
        if top.log_evidence < base.log_evidence + worth:
            best = top
            break
        found += _vary(task, top, rivals) if size == 2 else []
        best = eliminate(problem, choose_top([top, *found], top), more, found)
    found.sort(key=lambda c: -c.log_evidence)
    return Search(base, found, larger, best, first_gain, task.refused, task.scores, shape, alone)


class _Round(NamedTuple):
    """The search for one more effect.

    Attributes
    ----------
    size
        Effects that the larger sets have.
    best, found, rivals
        The best set so far, what was fitted, and the sets of the same size that compete.
    needed, more
        Gain [nats] that chance seldom exceeds, and that the further effect must bring.
    asked
        Log evidence [nats] that is asked of a larger set.
    shape
        What the best leaves, measured for a second effect.
    """

    size: int
    best: Candidate
    found: list[Candidate]
    rivals: list[Candidate]
    needed: float
    more: float
    asked: float
    shape: Shape | None

    def choose_floor(self, larger: list[Candidate]) -> float:
        """Log evidence [nats] below which no larger set could be chosen."""
        return max(self.asked, find_best(larger))


def _enlarge(task: Task, now: _Round) -> list[Candidate]:
    """Rank one more effect on sets that may lead.

    For a second effect that is every set, and any pair; none where the best single one leaves
    nothing. With the other form of the best, only what leads is tried.
    """
    best, second = now.best, now.size == 2
    larger = extend(task, best, task.pieces, now.asked)
    if second and _leaves_nothing(task, now, larger):
        return larger
    for rival in now.rivals:
        if rival is not best and (second or _can_lead(rival, best, larger)):
            larger += extend(task, rival, task.pieces, now.choose_floor(larger))
    other = find_other_form(now.found, best)
    if other is not None and (second or _can_lead(other, best, larger)):
        leading = keep_leading(task.pieces, larger, best)
        larger += extend(task, other, leading, now.choose_floor(larger))
    return [*larger, *_pair_up(task, now, larger)] if second else larger


def _leaves_nothing(task: Task, now: _Round, larger: list[Candidate]) -> bool:
    """Whether one effect leaves no more than chance gains.

    Neither a further effect nor a free-form term then gains it, so no other pair can lead.
    """
    demand = build_demand(now.needed, len({piece.effect.id for piece in task.pieces}))
    return max(find_best(larger) - now.best.log_evidence, now.shape.gain) <= demand.further


def _pair_up(task: Task, now: _Round, larger: list[Candidate]) -> list[Candidate]:
    """Fit the pairs that score best.

    Far from the base, where the best leaves much, also those of what leads.
    """
    pairs = rank_pairs(task.problem, task.base, task.columns, larger, now.asked, task.progress)
    explained = now.best.log_evidence - task.base.log_evidence
    if explained >= BUDGET.far_nats and now.shape.gain > now.more:
        floor = now.choose_floor([*larger, *pairs])
        pairs += fit_leading_pairs(task.problem, task.singles, floor, now.asked, task.progress)
    return pairs


def _vary(task: Task, top: Candidate, rivals: list[Candidate]) -> list[Candidate]:
    """Other forms of a pair, and other partners in it."""
    pieces = [*task.pieces, *list_finer(top, task.pieces)]
    found = swap_forms(task.problem, top, pieces, task.progress)
    return found + try_partners(task, top, {rival.model.ids for rival in rivals})


def _seek_hidden(task: Task, search: Search, needed: float) -> Search:
    """Take hidden sets where they explain more than a shape."""
    problem, base, columns = task.problem, task.base, task.columns
    needed = build_demand(needed, len(set(columns.label))).further
    hidden = seek_hidden(problem, base, columns, needed, task.progress)
    top = choose_top(hidden, base)
    if top is base or top.log_evidence - base.log_evidence <= measure_shape(problem, base).gain:
        return search
    pieces = list(dict.fromkeys(block.model.pieces[-1] for block in columns.blocks))
    found = [*search.candidates, *hidden, *swap_forms(problem, top, pieces, task.progress)]
    best = eliminate(problem, choose_top(found, top), needed, found)
    found.sort(key=lambda c: -c.log_evidence)
    gain = best.log_evidence - base.log_evidence
    return search._replace(candidates=found, best=best, first_gain=gain)


def require_gain(needed: float, explained: float, pieces: list[Piece], best: Candidate) -> float:
    """Gain [nats] that a further effect must bring.

    As much as a first one, and what it costs that there are so many more pairs than effects. Where
    an effect before has no free law, also more than the error that its textbook forms may have.
    """
    effects = len({piece.effect.id for piece in pieces})
    return build_demand(needed, effects, list_free(pieces)).ask(best.model.ids, explained)


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


def _face_finer(
    task: Task,
    top: Candidate,
    best: Candidate,
    found: list[Candidate],
    larger: list[Candidate],
    more: float,
) -> Candidate:
    """Let a set face finer laws of its parts.

    They, and what leads on top of them, are added to `found` and `larger`; returns the best of
    fewer effects.
    """
    finer = fit_finer(task.problem, top, found, task.pieces, task.progress)
    if not finer:
        return best
    found += finer
    best = choose_top([best, *finer], best)
    floor = max(best.log_evidence + more, find_best(larger))
    larger += extend(task, best, keep_leading(task.pieces, larger, best), floor)
    return best
