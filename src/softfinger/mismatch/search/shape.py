"""The best free-form term on top of a model."""

from typing import NamedTuple

from softfinger.inference.mixed_effects_laplace import Fit
from softfinger.inference.problem import Candidate, Problem
from softfinger.mismatch.candidates.rank import (
    competing_nats,
)
from softfinger.mismatch.checks.free_form import FreeForm, fit_free_form
from softfinger.mismatch.decisions import DECISIONS


class Shape(NamedTuple):
    """Best free-form term on a fit, or None.

    `ahead` is what the fitted model gains by a measurement of its own [nats].
    """

    fit: Fit
    free: FreeForm | None
    ahead: float = 0.0

    @property
    def gain(self) -> float:
        """Its gain [nats]."""
        return 0.0 if self.free is None else max(self.free.gain - self.ahead, 0.0)


def allow_rest(explained: float, needed: float) -> float:
    """Evidence [nats] for a rest that effects may leave."""
    return max(needed, DECISIONS.least_left, DECISIONS.shape_left * explained)


def measure_shape(problem: Problem, candidate: Candidate) -> Shape:
    """Fit the best free-form term over a model."""
    ahead = candidate.log_evidence - candidate.fit.log_evidence
    return Shape(candidate.fit, fit_free_form(problem, candidate), ahead)


def excels(shape: Shape, explained: float) -> bool:
    """Whether effects do not compete with a free-form term."""
    return shape.gain > explained + competing_nats(explained)
