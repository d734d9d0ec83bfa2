"""Pairs of the leading effects, each fitted on top of the other.

Where much is left out a linear score errs, and the evidence of a pair has several modes. Which of
them a fit reaches depends on the effect, and on its form, from which it starts.
"""

from collections import Counter

import numpy as np

from softfinger.inference.problem import Candidate, Problem
from softfinger.mechanics.effects.model import Piece
from softfinger.mismatch.budget import BUDGET
from softfinger.mismatch.candidates.elsewhere import list_compatible, list_elsewhere
from softfinger.mismatch.candidates.rank import Progress, Score, find_best, fit_scored


def fit_leading_pairs(
    problem: Problem, singles: list[Candidate], floor: float, asked: float, progress: Progress
) -> list[Candidate]:
    """Fit pairs of leading effects from either's fit.

    Parameters
    ----------
    singles
        Models of one effect, best first.
    floor, asked
        Log evidence [nats] that other pairs have, and that one must reach to be believed.
    """
    leading = _list_leading(singles)
    found: list[Candidate] = []
    for one in leading:
        others = [c.model.pieces[-1] for c in leading]
        pieces = list_compatible(one, list_elsewhere(problem, one.model, others))
        scores = [_place(one, piece) for piece in pieces]
        found += fit_scored(problem, one, scores, progress, max(floor, find_best(found)), asked)
    return found


def _list_leading(singles: list[Candidate]) -> list[Candidate]:
    """The best forms of the effects that gain most."""
    chosen, taken = [], Counter()
    for candidate in singles:
        name = candidate.model.pieces[-1].effect.id
        known = name in taken or len(taken) < BUDGET.leading_pairs
        if candidate.fit is not None and known and taken[name] < BUDGET.leading_forms:
            taken[name] += 1
            chosen.append(candidate)
    return chosen


def _place(one: Candidate, piece: Piece) -> Score:
    """A further effect at its start: it is fitted whatever its score."""
    model = one.model.extend(piece)
    at = len(one.model.pieces)
    start = model.place_start(at, model.list_starts(at)[0])
    return Score(model, np.inf, np.concatenate([one.fit.shared, start]))
