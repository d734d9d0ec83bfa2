"""Courses in time that turn back.

An effect by which a joint softens within a trial falls, by its name. Its free law may have any
course in time, and where all trials have one timing a course is a law of anything else too: of the
direction of motion, of rest. So a course that clearly rises again is not that effect.

A course rises from a time u to a later v, and falls from one s to a later t. It turns back where

    (c(v) − c(u)) − share · (c(s) − c(t)) > z · its sd,

each pair where the fitted course does most, z for the probability `DECISIONS.sure`.
"""

import numpy as np
from numpy.typing import NDArray
from scipy.stats import norm

from softfinger.inference.problem import Candidate, Problem
from softfinger.mechanics.effects.law_curve import PLACES
from softfinger.mechanics.effects.model import EffectModel
from softfinger.mismatch.decisions import DECISIONS

APART = 1e-3  # of the posterior sd, to differentiate a course


def list_turned(problem: Problem, candidate: Candidate) -> list[str]:
    """List effects that must fall and clearly rise again.

    What was in the base model is not judged.
    """
    if candidate.fit is None:
        return []
    time = np.linspace(0.0, problem.setting.duration, PLACES)
    return [
        piece.effect.id
        for number, piece in enumerate(candidate.model.pieces)
        if piece.effect.course is not None
        and piece.effect.id not in problem.base.ids
        and turns_back(*_follow(candidate, number, time))
    ]


def turns_back(course: NDArray[np.float64], covariance: NDArray[np.float64]) -> bool:
    """Whether any joint's course clearly rises again.

    Parameters
    ----------
    course
        (joint, n), the logarithm of what is left.
    covariance
        (joint, n, n).

    Examples
    --------
    >>> falling, turning = np.array([[0.0, -0.2, -0.3]]), np.array([[0.0, -0.3, 0.0]])
    >>> turns_back(falling, 1e-4 * np.eye(3)[None]), turns_back(turning, 1e-4 * np.eye(3)[None])
    (False, True)
    """
    later = np.triu(np.ones((course.shape[1],) * 2, bool))
    for one, spread in zip(course, covariance, strict=True):
        climb = np.where(later, one[None] - one[:, None], 0.0)  # from row to column
        weight = np.zeros(len(one))
        for pair, sign in ((climb.argmax(), 1.0), (climb.argmin(), DECISIONS.turns_back)):
            start, end = np.unravel_index(pair, climb.shape)
            weight[end] += sign
            weight[start] -= sign
        sd = np.sqrt(max(weight @ spread @ weight, 0.0))
        if weight @ one > norm.ppf(DECISIONS.sure) * sd:
            return True
    return False


def _follow(
    candidate: Candidate, number: int, time: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """A piece's course (joint, n) and its linearised covariance."""
    model, fit = candidate.model, candidate.fit
    mine = [k for k, entry in enumerate(model.entries) if entry.piece == number]
    slopes = []
    for k in mine:
        step = np.zeros(len(fit.shared))
        step[k] = APART * np.sqrt(fit.shared_covariance[k, k])
        ends = (_draw(model, number, fit.shared + sign * step, time) for sign in (0.5, -0.5))
        slopes.append(np.subtract(*ends) / step[k])
    slope = np.stack(slopes, axis=-1)
    spread = fit.shared_covariance[np.ix_(mine, mine)]
    covariance = np.einsum("jnk,kl,jml->jnm", slope, spread, slope)
    return _draw(model, number, fit.shared, time), covariance


def _draw(
    model: EffectModel, number: int, shared: NDArray[np.float64], time: NDArray[np.float64]
) -> NDArray[np.float64]:
    return model.pieces[number].effect.course(model.fill_piece(number, shared), time)
