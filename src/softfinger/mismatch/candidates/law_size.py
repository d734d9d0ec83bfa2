"""The prior size of a free law, chosen by evidence.

A law of seven terms that changes a moment arm by 2 % pays for each term as if it could change it by
half. So its size is one of a few (`PRIORS.law_sizes`), that of most evidence; chance's gains are
drawn with the same choice (`calibrate`).
"""

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from softfinger.inference.problem import Problem
from softfinger.mechanics.effects.model import EffectModel
from softfinger.mismatch.budget import BUDGET
from softfinger.mismatch.candidates.linearised import Linearised, evaluate_linearised
from softfinger.mismatch.priors import PRIORS


def list_sizes(model: EffectModel, number: int) -> Iterator[EffectModel]:
    """List a model with each size of one piece's law.

    The model itself comes first; alone, where the piece has no law.
    """
    yield model
    piece = model.pieces[number]
    if piece.form.law is None:
        return
    for size in PRIORS.law_sizes:
        if size != piece.size:
            pieces = list(model.pieces)
            pieces[number] = replace(piece, size=size)
            yield replace(model, pieces=tuple(pieces))


def resize_laws(problem: Problem, model: EffectModel, there: Linearised) -> EffectModel:
    """Give each law the size of most evidence.

    That of the model linearised where it was fitted; what gains less than a fit costs stays.
    """
    for number in range(len(model.pieces)):
        sized = list(list_sizes(model, number))
        if len(sized) == 1:
            continue
        value = [evaluate_linearised(problem, one, there, rounds=0) for one in sized]
        if max(value) - value[0] > BUDGET.resize_nats:
            model = sized[int(np.argmax(value))]
    return model
