"""Effects that may join a model: they act in other places.

Effects of one place are one law there, of which several are species: second retardation and power
law are both creep in time. A set that claims two of them claims that law twice.
"""

from collections.abc import Iterable

from softfinger.faults import Fault
from softfinger.inference.problem import Candidate, Problem
from softfinger.mechanics.effects.model import EffectModel, Piece


def list_elsewhere(problem: Problem, model: EffectModel, pieces: Iterable[Piece]) -> list[Piece]:
    """List pieces of effects that act in no place that a model has filled.

    What was in the base model fills its own effect's place alone: there its law is not sought.
    """
    setting, given = problem.setting, problem.base.ids
    added = [p.effect for p in model.pieces if p.effect.id not in given]
    filled = {effect.find_place(setting) for effect in added}
    return [
        p
        for p in pieces
        if p.effect.id not in model.ids and p.effect.find_place(setting) not in filled
    ]


def list_compatible(candidate: Candidate, pieces: Iterable[Piece]) -> list[Piece]:
    """Pieces that claim no slot in another sense."""
    fitting = []
    for piece in pieces:
        try:
            model = candidate.model.extend(piece)
            model.fill_slots(model.shared_prior[0])
        except (Fault, ValueError, ArithmeticError):
            continue
        fitting.append(piece)
    return fitting
