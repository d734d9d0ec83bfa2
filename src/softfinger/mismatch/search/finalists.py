"""Which models are judged with measurements of their own."""

from softfinger.inference.problem import Candidate
from softfinger.mismatch.budget import BUDGET
from softfinger.mismatch.search.stepwise import Search

Ids = frozenset[str]


def list_finalists(search: Search, rivals: list[Candidate]) -> list[Candidate]:
    """The best model of each leading set, and rivals of other forms.

    What leads with a disturbance need not lead without it: of one set both forms compete.
    """
    sets: dict[Ids, Candidate] = {search.base.model.ids: search.base}
    for candidate in search.candidates:
        if candidate.fit is not None and len(sets) <= BUDGET.finalists:
            sets.setdefault(candidate.model.ids, candidate)
    finalists: dict[frozenset[str], Candidate] = {}
    for candidate in (*sets.values(), search.best, *rivals):
        pieces = frozenset(piece.label for piece in candidate.model.pieces)
        finalists.setdefault(pieces, candidate)
    return list(finalists.values())


def list_best(search: Search) -> list[Candidate]:
    """The best sets of a search, a model of each.

    None where nothing but its base was fitted.
    """
    sets: dict[Ids, Candidate] = {}
    for candidate in (search.best, *search.candidates):
        if candidate.fit is not None and candidate.model.ids != search.base.model.ids:
            sets.setdefault(candidate.model.ids, candidate)
    return list(sets.values())[: 1 + BUDGET.rivals]
