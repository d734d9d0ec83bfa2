"""What a linear model promises of the place that it was made at."""

import numpy as np
import pytest

from softfinger.inference.mixed_effects_quadratic import Quadratic

VALUE = 100.0


def bend(curvature, slope):
    """A misfit of one trial with one parameter, and its best step."""
    curvature, slope = np.full((1, 1, 1), curvature), np.full((1, 1), slope)
    alone = Quadratic(curvature, np.zeros((1, 1, 1)), np.eye(1), slope, np.zeros(1), VALUE)
    return alone, slope / curvature[:, :, 0]


@pytest.mark.parametrize("curvature", [1e-6, 1.0, 1e9])
def test_the_best_step_promises_what_it_gains(curvature):
    misfit, best = bend(curvature, np.sqrt(2.0 * curvature * 60.0))
    assert misfit.promise((best, np.zeros(1))) == pytest.approx(60.0)
    assert misfit.promise((0.0 * best, np.zeros(1))) == 0.0


def test_an_answer_that_is_worse_than_its_place_promises_all_of_the_misfit():
    """Its evidence was then above that of any model."""
    misfit, best = bend(1e15, 1.0)
    assert misfit.promise((best + 5.0, np.zeros(1))) == VALUE
