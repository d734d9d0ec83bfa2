"""One more effect on top of a fitted set."""

from collections.abc import Iterable
from typing import NamedTuple

from softfinger.inference.problem import Candidate, Problem
from softfinger.mechanics.effects.model import Piece
from softfinger.mismatch.candidates.columns import ScoreColumns, collect_columns
from softfinger.mismatch.candidates.elsewhere import list_compatible, list_elsewhere
from softfinger.mismatch.candidates.rank import Progress, Score, rank_pieces
from softfinger.mismatch.search.eliminate import fit_without, list_added


class Task(NamedTuple):
    """What a search is given.

    Attributes
    ----------
    pieces
        Every form that the campaign allows.
    refused
        Effect id → why the campaign cannot show it.
    columns
        Of the catalogue, on top of the base model.
    singles, scores
        What `rank_pieces` gives for it there.
    progress
        Wraps the long loops.
    """

    problem: Problem
    base: Candidate
    pieces: list[Piece]
    refused: dict[str, str]
    columns: ScoreColumns
    singles: list[Candidate]
    scores: list[Score]
    progress: Progress


def extend(task: Task, rival: Candidate, pieces: Iterable[Piece], floor: float) -> list[Candidate]:
    """Rank every further effect; `floor` as in `fit_scored`."""
    problem, progress = task.problem, task.progress
    more = list_compatible(rival, list_elsewhere(problem, rival.model, pieces))
    columns = collect_columns(problem, rival, progress(more, "trying effects"))
    return rank_pieces(problem, rival, columns, progress, floor)[0]


def try_partners(task: Task, pair: Candidate, tried: set[frozenset[str]]) -> list[Candidate]:
    """Rank every partner of either effect of a pair.

    Those `tried` with all others are left out. One that gains little alone is met
    through the other only, which need not be its true partner
    (floating search: Pudil, Novovičová and Kittler 1994, Pattern Recognit. Lett. 15, 1119).
    """
    found = []
    for piece in list_added(task.problem, pair):
        if pair.model.ids - {piece.effect.id} in tried:
            continue
        alone = fit_without(task.problem, pair, piece)
        if alone is not None:
            found += extend(task, alone, task.pieces, pair.log_evidence)
    return found
