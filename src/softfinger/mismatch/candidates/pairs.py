"""Pairs and triples of effects that hide each other.

They are found where none of the effects gains much alone.

Forward addition meets a pair only through one of its members. One Gram matrix contains the columns
of every form on top of one fitted model, so any two of them are scored together as one alone.
"""

from collections import Counter
from collections.abc import Iterable, Iterator
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
    scores = [
        score for score, _ in _score(problem, origin, columns, join_pairs(problem, origin, columns))
    ]
    return _fit_best(problem, origin, scores, known, asked, progress)


def rank_triples(
    problem: Problem,
    origin: Candidate,
    columns: ScoreColumns,
    known: Iterable[Candidate],
    asked: float,
    progress: Progress,
) -> list[Candidate]:
    """Fit the best triples of effects, as `rank_pairs` does.

    Each is one of the pairs that score best, with any third effect.
    """
    pairs = _score(problem, origin, columns, join_pairs(problem, origin, columns))
    best: dict[frozenset[str], Block] = {}
    for score, block in pairs:
        best.setdefault(score.model.ids, block)
    leading = list(best.values())[: BUDGET.paired]
    singles = _choose_forms(problem, origin, columns)
    joined = (_join(problem, pair, one) for pair in leading for one in singles)
    scores = _score(problem, origin, columns, (block for block in joined if block is not None))
    return _fit_best(problem, origin, [score for score, _ in scores], known, asked, progress)


def _fit_best(
    problem: Problem,
    origin: Candidate,
    scores: list[Score],
    known: Iterable[Candidate],
    asked: float,
    progress: Progress,
) -> list[Candidate]:
    before = {c.model.ids for c in known if c.fit is not None}
    best: dict[frozenset[str], Score] = {}
    for score in scores:
        best.setdefault(score.model.ids, score)
    fresh = [score for ids, score in list(best.items())[: BUDGET.pairs] if ids not in before]
    return fit_scored(problem, origin, fresh, progress, max(asked, find_best(known)), asked)


def join_pairs(problem: Problem, origin: Candidate, columns: ScoreColumns) -> Iterator[Block]:
    """Join forms of different effects two by two."""
    for one, other in combinations(_choose_forms(problem, origin, columns), 2):
        pair = _join(problem, one, other)
        if pair is not None:
            yield pair


def _join(problem: Problem, one: Block, other: Block) -> Block | None:
    """Join blocks of effects with different places."""
    place = other.model.pieces[-1].effect.find_place(problem.setting)
    known = problem.base.ids
    taken = {
        p.effect.find_place(problem.setting) for p in one.model.pieces if p.effect.id not in known
    }
    return None if place in taken else join_blocks(one, other)


def _score(
    problem: Problem, origin: Candidate, columns: ScoreColumns, blocks: Iterable[Block]
) -> list[tuple[Score, Block]]:
    """Score sets of forms over the fit, best first."""
    scored = [
        (Score(block.model, score_block(problem, origin, columns, block), block.shared), block)
        for block in blocks
    ]
    return sorted(scored, key=lambda pair: -pair[0].gain)


def _choose_forms(problem: Problem, origin: Candidate, columns: ScoreColumns) -> list[Block]:
    starts = sorted(choose_starts(problem, origin, columns), key=lambda start: -start[0])
    chosen, taken = [], Counter()
    for _, block in starts:
        name = block.model.pieces[-1].effect.id
        if taken[name] < BUDGET.forms:
            taken[name] += 1
            chosen.append(block)
    return chosen
