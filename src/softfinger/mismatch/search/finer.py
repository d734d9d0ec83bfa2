"""Finer laws, which a further effect has to beat.

What a free law leaves may be a corner or a wave for which it has too few terms. Before a further
effect is believed, each smaller set of its effects is tried with finer laws. Nor is an effect
believed before its rivals are tried so: play that opens softly is no one gap, and a damper that
thins can be nearer to it.
"""

from collections.abc import Iterable

from softfinger.inference.problem import Candidate, Problem
from softfinger.mechanics.effects.model import Piece
from softfinger.mismatch.budget import BUDGET
from softfinger.mismatch.candidates.other_forms import list_finer, swap_forms
from softfinger.mismatch.candidates.rank import Progress, reaching_nats


def fit_finer(
    problem: Problem,
    top: Candidate,
    found: list[Candidate],
    pieces: Iterable[Piece],
    progress: Progress = lambda items, _: items,
) -> list[Candidate]:
    """Fit the parts of a set with finer laws.

    Parameters
    ----------
    pieces
        The catalogue.
    progress
        As of `swap_forms`.

    Returns
    -------
    list of Candidate
        Those that gain. A part is the best model found of fewer of the set's effects.
    """
    fitted = [c for c in found if c.fit is not None and c.model.ids < top.model.ids]
    parts = {c.model.ids: c for c in sorted(fitted, key=lambda c: c.log_evidence)}
    finer = []
    for part in parts.values():
        finer += swap_forms(problem, part, list_finer(part, pieces), progress)
    return finer


def fit_rivals_finer(
    problem: Problem,
    base: Candidate,
    best: Candidate,
    found: list[Candidate],
    pieces: Iterable[Piece],
    progress: Progress = lambda items, _: items,
) -> list[Candidate]:
    """Fit the rivals of a set with finer laws.

    Rivals are sets of as many other effects that come near, the nearest first.

    Parameters
    ----------
    pieces, progress
        As of `fit_finer`.

    Returns
    -------
    list of Candidate
        Those that gain.
    """
    floor = best.log_evidence - reaching_nats(best.log_evidence - base.log_evidence)
    near: dict[frozenset[str], Candidate] = {}
    for one in sorted(found, key=lambda c: -c.log_evidence):
        if one.log_evidence >= floor and len(one.model.ids) == len(best.model.ids):
            near.setdefault(one.model.ids, one)
    near.pop(best.model.ids, None)
    finer = []
    for rival in list(near.values())[: BUDGET.rivals]:
        finer += swap_forms(problem, rival, list_finer(rival, pieces), progress)
    return finer
