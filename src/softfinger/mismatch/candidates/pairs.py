"""Pairs of effects that hide each other.

They are found where neither effect gains much alone.

Forward addition meets a pair only through one of its members. One Gram matrix contains the columns
of every form on top of one fitted model, so any two of them are scored together as one alone.
"""

from collections import Counter
from collections.abc import Iterable
from itertools import combinations

from softfinger.inference.problem import Candidate, Problem
from softfinger.mismatch.budget import BUDGET
from softfinger.mismatch.candidates.columns import Block, ScoreColumns, join_blocks
from softfinger.mismatch.candidates.rank import (
    Progress,
    Score,
    choose_starts,
    find_best,
    fit_scored,
    score_block,
)


def rank_pairs(
    problem: Problem,
    origin: Candidate,
    columns: ScoreColumns,
    known: Iterable[Candidate],
    asked: float,
    progress: Progress,
) -> list[Candidate]:
    """Fit the best pairs of effects over a model.

    Those that score best are fitted, but for those known.

    Parameters
    ----------
    columns
        Of the catalogue, on top of the fitted model.
    known
        Pairs that were fitted before.
    asked
        Log evidence [nats] that a pair must reach to be believed.
    """
    before = {c.model.ids for c in known if c.fit is not None}
    best: dict[frozenset[str], Score] = {}
    for score in score_pairs(problem, origin, columns):
        best.setdefault(score.model.ids, score)
    fresh = [score for ids, score in list(best.items())[: BUDGET.pairs] if ids not in before]
    return fit_scored(problem, origin, fresh, progress, max(asked, find_best(known)))


def score_pairs(problem: Problem, origin: Candidate, columns: ScoreColumns) -> list[Score]:
    """Score forms two by two over the fit."""
    scores = []
    for one, other in combinations(_choose_forms(problem, origin, columns), 2):
        places = {b.model.pieces[-1].effect.find_place(problem.setting) for b in (one, other)}
        pair = join_blocks(one, other) if len(places) == 2 else None
        if pair is not None:
            gain = score_block(problem, origin, columns, pair)
            scores.append(Score(pair.model, gain, pair.shared))
    return sorted(scores, key=lambda score: -score.gain)


def _choose_forms(problem: Problem, origin: Candidate, columns: ScoreColumns) -> list[Block]:
    starts = sorted(choose_starts(problem, origin, columns), key=lambda start: -start[0])
    chosen, taken = [], Counter()
    for _, block in starts:
        name = block.model.pieces[-1].effect.id
        if taken[name] < BUDGET.forms:
            taken[name] += 1
            chosen.append(block)
    return chosen
