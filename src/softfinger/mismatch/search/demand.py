"""What effects must gain to be believed."""

from collections.abc import Iterable
from typing import NamedTuple

import numpy as np

from softfinger.inference.problem import Candidate
from softfinger.mechanics.effects.model import Piece
from softfinger.mismatch.decisions import DECISIONS

Ids = frozenset[str]


class Demand(NamedTuple):
    """Gain [nats] that a first and that a further effect must bring.

    There are as many more pairs than effects as there are effects.

    Attributes
    ----------
    free
        Effects that have a free law; None where all have.
    """

    first: float
    further: float
    free: Ids | None = None

    def ask(self, ids: Ids, explained: float) -> float:
        """What one more must gain beside effects [nats].

        Where one of them has no free law, also more than the error that textbook forms may have.

        >>> Demand(5.0, 8.0, frozenset()).ask(frozenset({"inertia"}), 1000.0)
        13.0
        """
        if not ids:
            return self.first
        error = 0.0 if self.free is None else allow_form_error(ids, explained, self.free)
        return self.further + error


def build_demand(needed: float, effects: int, free: Ids | None = None) -> Demand:
    """Build it from what chance seldom gains.

    Parameters
    ----------
    needed
        Gain [nats] over the whole catalogue.
    effects
        How many effects are tried.
    free
        Those that have a free law.

    >>> round(build_demand(5.0, 20).further, 3)
    7.996
    """
    return Demand(needed, needed + float(np.log(max(effects, 1))), free)


def choose_simplest(candidates: list[Candidate], base: Ids, demand: Demand) -> Candidate:
    """The best model, or one of fewer effects that is close.

    As in the search, whichever effects they are: what more effects gain must be more than is
    demanded of a first effect, or of a further one.
    """
    best = max(candidates, key=lambda c: c.log_evidence)
    bare = next((c.log_evidence for c in candidates if c.model.ids == base), best.log_evidence)
    for simpler in sorted(candidates, key=lambda c: (-len(c.model.ids), -c.log_evidence)):
        asked = demand.ask(simpler.model.ids - base, simpler.log_evidence - bare)
        close = best.log_evidence - simpler.log_evidence <= asked
        if close and len(simpler.model.ids) < len(best.model.ids):
            best = simpler
    return best


def list_free(pieces: Iterable[Piece]) -> Ids:
    """Effects that have a free law."""
    return frozenset(piece.effect.id for piece in pieces if piece.form.is_free)


def allow_form_error(ids: Ids, explained: float, free: Ids) -> float:
    """Evidence [nats] that textbook forms of effects may leave.

    None where each has a free law.

    Parameters
    ----------
    explained
        What the effects explain [nats].
    free
        Effects that have a free law.

    >>> allow_form_error(frozenset({"inertia"}), 1000.0, frozenset({"actuator_lag"}))
    5.0
    """
    return 0.0 if ids <= free else DECISIONS.form_error * max(explained, 0.0)
