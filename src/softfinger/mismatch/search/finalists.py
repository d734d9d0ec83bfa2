"""Which models are judged with measurements of their own."""

from softfinger.inference.problem import Candidate
from softfinger.mismatch.budget import BUDGET
from softfinger.mismatch.decisions import DECISIONS
from softfinger.mismatch.search.stepwise import Search

Ids = frozenset[str]


def find_leader(base: Candidate, singles: list[Candidate], needed: float) -> Candidate:
    """Find the best of base model and leading effects."""
    leaders = base, *list_leaders(base, singles, needed)
    return max(leaders, key=lambda c: c.log_evidence)


def list_leaders(base: Candidate, singles: list[Candidate], needed: float) -> list[Candidate]:
    """Best model of each of the leading effects."""
    leaders: dict[frozenset[str], Candidate] = {}
    for candidate in singles:
        gain = candidate.log_evidence - base.log_evidence
        if candidate.fit is not None and gain > needed and len(leaders) < BUDGET.leaders:
            leaders.setdefault(candidate.model.ids, candidate)
    return list(leaders.values())


def list_finalists(search: Search, rivals: list[Candidate]) -> list[Candidate]:
    """The best model of each leading set, and rivals of other forms.

    What leads with a disturbance need not lead without it: of one set both forms compete. Of sets
    of more effects than are named none but the best counts, with a disturbance and without.
    """
    known = search.base.model.ids

    def is_few(candidate: Candidate) -> bool:
        return len(candidate.model.ids - known) <= DECISIONS.most_named

    sets: dict[Ids, Candidate] = {known: search.base}
    for candidate in filter(is_few, search.candidates):
        if candidate.fit is not None and len(sets) <= BUDGET.finalists:
            sets.setdefault(candidate.model.ids, candidate)
    kept = [rival for rival in rivals if rival is rivals[0] or is_few(rival)]
    finalists: dict[frozenset[str], Candidate] = {}
    for candidate in (*sets.values(), search.best, *kept):
        pieces = frozenset(piece.label for piece in candidate.model.pieces)
        finalists.setdefault(pieces, candidate)
    return list(finalists.values())


def list_best(search: Search) -> list[Candidate]:
    """The best sets of a search, a model of each.

    Also the best that is part of each, one effect less: what a set has more is held against its
    best form. None where nothing but the base was fitted.
    """
    sets: dict[Ids, Candidate] = {}
    for candidate in (search.best, *search.candidates):
        if candidate.fit is not None and candidate.model.ids != search.base.model.ids:
            sets.setdefault(candidate.model.ids, candidate)
    leading = list(sets)[: 1 + BUDGET.rivals]
    parts = (
        next((part for part in sets if part < ids and len(part) == len(ids) - 1), ids)
        for ids in leading
    )
    return [sets[ids] for ids in dict.fromkeys([*leading, *parts])]
