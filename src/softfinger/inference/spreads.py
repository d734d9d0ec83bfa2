"""Parameters of effects that differ from trial to trial.

A trial whose parameter is φ (1 + s z), z ~ N(0, 1), moves to first order by s z φ ∂F/∂φ beside
what φ alone does; one that is fitted as its logarithm, by s z ∂F/∂log φ. So a spread s between
trials is a disturbance along the effect's own tangents. It is nothing at s = 0, and evidence
decides. What acts between trials has no spread of its own: that is the joints' own.
"""

import numpy as np
from numpy.typing import NDArray

from softfinger.inference.problem import Candidate
from softfinger.mechanics.effects.spread import MARK, may_vary, name_spread, name_varying

Array = NDArray[np.float64]


def is_spread(component: str) -> bool:
    """Whether a component is a spread of an effect's parameter."""
    return MARK in component


def find_effect(spread: str) -> str:
    """Id of the effect whose parameter has a spread.

    >>> find_effect("wire_friction:coefficient")
    'wire_friction'
    """
    return spread.split(MARK)[0]


def list_spreads(candidate: Candidate, slope: Array) -> dict[str, Array]:
    """What spreads of relative size 1 move the angles by.

    Parameters
    ----------
    slope
        (trial, joint, bin · 2, 4 · joint + p) [rad] by η and φ.

    Returns
    -------
    dict
        Id → (trial, joint, bin · 2, place) [rad]; empty where there is one trial.
    """
    if len(slope) < 2:
        return {}
    model, shared = candidate.model, candidate.fit.shared
    own = slope.shape[3] - len(shared)
    found: dict[str, dict[tuple, Array]] = {}
    for k, entry in enumerate(model.entries):
        piece = model.pieces[entry.piece]
        if not may_vary(piece):
            continue
        size = 1.0 if entry.parameter.log else shared[k]
        places = found.setdefault(name_spread(piece.effect.id, name_varying(model, k)), {})
        places[entry.place] = places.get(entry.place, 0.0) + size * slope[..., own + k]
    return {name: np.stack(list(places.values()), axis=-1) for name, places in found.items()}
