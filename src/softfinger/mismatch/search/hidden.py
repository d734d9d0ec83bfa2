"""Sets of effects where no single one competes.

Two effects that act against each other may each gain nothing alone. Where something lasts within
trials that the base model does not explain, and no effect alone gains what is asked, pairs are
scored, and then triples.
"""

import numpy as np

from softfinger.inference.problem import Candidate, Problem
from softfinger.mismatch.candidates.columns import ScoreColumns
from softfinger.mismatch.candidates.pairs import rank_pairs, rank_triples
from softfinger.mismatch.candidates.rank import Progress, find_best
from softfinger.mismatch.checks.summary import compute_excess
from softfinger.mismatch.decisions import DECISIONS


def seek_hidden(
    problem: Problem,
    base: Candidate,
    columns: ScoreColumns,
    needed: float,
    progress: Progress,
) -> list[Candidate]:
    """Fit pairs and triples that hide each other.

    There are none where the base model leaves nothing that lasts.

    Parameters
    ----------
    columns
        Of the catalogue, on top of the base model.
    needed
        Gain [nats] that a pair must bring; a triple must bring more, for there are more of them.

    Returns
    -------
    list
        Those that bring it, best first.
    """
    if not columns.blocks or compute_excess(problem, base)[1] >= DECISIONS.missing:
        return []
    effects = len(set(columns.label))
    for rank, asked in (
        (rank_pairs, base.log_evidence + needed),
        (rank_triples, base.log_evidence + needed + float(np.log(effects))),
    ):
        found = [c for c in rank(problem, base, columns, [], asked, progress) if c.fit is not None]
        if find_best(found) > asked:
            return [c for c in found if c.log_evidence > asked]
    return []
