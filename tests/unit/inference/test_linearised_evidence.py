"""A linearised model without a solution has no evidence, and ends nothing."""

import numpy as np

from softfinger.inference.mixed_effects import Prior
from softfinger.inference.mixed_effects_linearised import SharedBounds, measure_linearised

FREE = SharedBounds(np.full(1, -np.inf), np.full(1, np.inf), np.full(1, np.inf))


def measure(precision):
    """Evidence of two trials that show nothing of one shared number, which has a prior or none."""
    gram = np.zeros((2, 3, 3))
    gram[:, 2, 2] = 1.0
    prior = Prior(np.zeros(2), np.array([1.0, precision]), np.ones(1), 1e12, 1)
    return measure_linearised(gram, prior, FREE, (np.zeros((2, 1)), np.zeros(1)), np.eye(1), 3)


def test_a_model_without_a_solution_has_no_evidence():
    """Two joints that a third one drives ended a diagnosis with an error of linear algebra."""
    assert measure(0.0) == -np.inf
    assert np.isfinite(measure(1.0))
