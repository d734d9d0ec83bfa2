"""How much a parameter of an effect differs between trials.

A trial whose parameter is φ has φ (1 + s z), z ~ N(0, 1); of one that is fitted as its logarithm
log φ + s z. All terms of a free law differ together. What acts between trials has no spread of its
own: that is the joints' own.
"""

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from softfinger.mechanics.effects.model import EffectModel, Piece

MARK = ":"
CLOCK = "camera_delay"
"""A delay that differs between trials is an error of the clock."""


def name_spread(effect: str, parameter: str) -> str:
    """Name of a parameter's spread.

    >>> name_spread("wire_friction", "coefficient")
    'wire_friction:coefficient'
    """
    return f"{effect}{MARK}{parameter}"


def may_vary(piece: Piece) -> bool:
    """Whether parameters of an effect may differ between trials."""
    return piece.effect.level != "between_trials" and piece.effect.id != CLOCK


def name_varying(model: EffectModel, k: int) -> str:
    """Name of what number k of φ varies with."""
    entry = model.entries[k]
    if not entry.parameter.term:
        return entry.parameter.name
    law = model.pieces[entry.piece].form.law
    return law.name if law else "law"


def list_varying(piece: Piece, model: EffectModel) -> list[str]:
    """Parameters of a piece that may differ between trials."""
    if not may_vary(piece):
        return []
    mine = (k for k, entry in enumerate(model.entries) if model.pieces[entry.piece] is piece)
    return list(dict.fromkeys(name_varying(model, k) for k in mine))


def name_spreads(sizes: Mapping[str, Mapping[str, float]]) -> dict[str, float]:
    """Name the spreads of effects' parameters.

    >>> name_spreads({"inertia": {}, "wire_friction": {"coefficient": 0.2}})
    {'wire_friction:coefficient': 0.2}
    """
    return {
        name_spread(effect, parameter): size
        for effect, own in sizes.items()
        for parameter, size in own.items()
    }


def take_spreads(piece: Piece, model: EffectModel, sizes: Mapping[str, float]) -> dict[str, float]:
    """Take a piece's spreads, by its parameters, from all."""
    names = {name: name_spread(piece.effect.id, name) for name in list_varying(piece, model)}
    return {name: sizes[known] for name, known in names.items() if known in sizes}


def doubt_spreads(sizes: Mapping[str, float], piece: Piece, model: EffectModel) -> list[str]:
    """Sentences on spreads that a piece cannot have."""
    names = list_varying(piece, model)
    here = f"there are {', '.join(names)}" if names else "nothing of this effect has one"
    strange = (name for name in sizes if name not in names)
    return [f"{name!r} has no spread between trials; {here}" for name in strange]


def vary_effects(
    model: EffectModel,
    effect: NDArray[np.float64],
    sizes: Mapping[str, float],
    rng: np.random.Generator,
) -> NDArray[np.float64]:
    """Draw the effects' parameters of new trials.

    Parameters
    ----------
    effect
        (m, p) φ on the internal scale, of each trial's finger.
    sizes
        Spread's name → relative sd; what has none stays as it is.

    Returns
    -------
    (m, p), within the bounds of φ.
    """
    varied, drawn = effect.copy(), {}
    for k, entry in enumerate(model.entries):
        name = name_spread(model.pieces[entry.piece].effect.id, name_varying(model, k))
        if name not in sizes:
            continue
        if (name, entry.place) not in drawn:
            drawn[name, entry.place] = rng.standard_normal(len(effect))
        shift = sizes[name] * drawn[name, entry.place]
        varied[:, k] += shift if entry.parameter.log else shift * effect[:, k]
    return np.clip(varied, model.low, model.high) if drawn else varied
