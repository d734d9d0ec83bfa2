"""Bounded effects as unbounded numbers: there and back, and the volume of the way."""

import numpy as np
import pytest

from softfinger.inference.bounded import bind, log_slope, place_effects, unbind

BOUNDS = {
    "free": (-np.inf, np.inf),
    "low": (0.5, np.inf),
    "high": (-np.inf, 2.0),
    "both": (0.5, 2.0),
}
NUMBERS = np.linspace(-6.0, 6.0, 13)


@pytest.mark.parametrize("kind", BOUNDS)
@pytest.mark.parametrize("scale", [0.01, 0.7])
def test_there_and_back(kind, scale):
    low, high = (np.full(13, bound) for bound in BOUNDS[kind])
    width = np.full(13, scale)
    effect = bind(NUMBERS, low, high, width)
    assert ((effect > low) & (effect < high)).all()
    np.testing.assert_allclose(unbind(effect, low, high, width), NUMBERS, atol=1e-6)


@pytest.mark.parametrize("kind", BOUNDS)
def test_the_slope_is_that_of_differences(kind):
    low, high = (np.full(13, bound) for bound in BOUNDS[kind])
    width, step = np.full(13, 0.3), 1e-5
    rise = bind(NUMBERS + step, low, high, width) - bind(NUMBERS - step, low, high, width)
    slope = np.exp(log_slope(NUMBERS, low, high, width))
    np.testing.assert_allclose(slope, rise / (2 * step), rtol=1e-6)


def test_a_number_far_from_its_bound_keeps_the_covariance_of_the_fit():
    covariance = np.array([[0.04, 0.01], [0.01, 0.09]])
    low = np.array([0.0, -np.inf])
    placed = place_effects(np.array([9.0, 1.0]), covariance, low, np.full(2, np.inf))
    z = np.random.default_rng(1).standard_normal((40_000, 2))
    drawn = placed.bind(placed.centre + z @ placed.root.T)
    np.testing.assert_allclose(np.cov(drawn.T), covariance, atol=0.003)
    np.testing.assert_allclose(drawn.mean(axis=0), [9.0, 1.0], atol=0.01)


def test_a_mode_on_its_bound_starts_inside_within_reach_of_null():
    placed = place_effects(np.zeros(1), np.full((1, 1), 0.04), np.zeros(1), np.full(1, np.inf))
    middle = placed.bind(placed.centre)
    assert 0.1 < middle[0] < 0.4
    far = placed.bind(placed.centre - 6 * placed.root[:, 0])
    assert 0 < far[0] < 0.01
