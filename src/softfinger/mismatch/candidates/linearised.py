"""The evidence of models that are linearised at a fit."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from softfinger.inference.mixed_effects_laplace import Fit
from softfinger.inference.mixed_effects_linearised import solve_linearised
from softfinger.inference.problem import Problem
from softfinger.mechanics.effects.model import EffectModel


class Linearised(NamedTuple):
    """A model linearised at (η, φ).

    Gram matrices of [∂F/∂η | ∂F/∂φ | residual], and Ω.
    """

    gram: NDArray[np.float64]
    own: NDArray[np.float64]
    shared: NDArray[np.float64]
    omega: NDArray[np.float64]


def place_fit(fit: Fit) -> Linearised:
    """Linearise a model where it was fitted."""
    return Linearised(fit.gram, fit.own, fit.shared, fit.omega)


def drop_places(
    problem: Problem, model: EffectModel, there: Linearised, *, rounds: int
) -> tuple[EffectModel, float]:
    """Drop the last piece's places while evidence rises."""
    now, evidence = model, evaluate_linearised(problem, model, there, rounds)
    while True:
        last = len(now.pieces) - 1
        smaller = [
            now.without(e)
            for e in now.entries
            if e.parameter.amplitude
            and e.place
            and e.piece == last
            and len(now.pieces[last].places) > 1
        ]
        values = [evaluate_without(problem, model, there, other, rounds) for other in smaller]
        if not values or max(values) <= evidence:
            return now, evidence
        now, evidence = smaller[int(np.argmax(values))], max(values)


def evaluate_without(
    problem: Problem, model: EffectModel, there: Linearised, smaller: EffectModel, rounds: int
) -> float:
    """Log evidence of a model with a smaller φ.

    It is linearised where the larger one is.
    """
    d = len(there.omega)
    kept = model.match(smaller)
    absent = np.setdiff1d(np.flatnonzero(model.amplitudes), kept)
    shift = np.eye(there.gram.shape[1])  # the residual without what the absent amplitudes add
    shift[d + absent, -1] = there.shared[absent]
    columns = np.concatenate([np.arange(d), d + kept, [len(shift) - 1]])
    gram = (shift.T @ there.gram @ shift)[:, columns[:, None], columns]
    there = there._replace(gram=gram, shared=there.shared[kept])
    return evaluate_linearised(problem, smaller, there, rounds)


def evaluate_linearised(
    problem: Problem, model: EffectModel, there: Linearised, rounds: int
) -> float:
    """Log evidence; −∞ where the linear model cannot be solved."""
    try:
        return solve_linearised(
            there.gram,
            problem.build_prior(model),
            problem.build_bounds(model),
            (there.own, there.shared),
            there.omega,
            rounds=rounds,
        )[1]
    except np.linalg.LinAlgError:  # as of a fit: numbers that leave the range have no evidence
        return -np.inf
