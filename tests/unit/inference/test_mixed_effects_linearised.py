"""Shared parameters within their bounds."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from scipy.optimize import minimize

from softfinger.inference.mixed_effects import Prior, fit_linear
from softfinger.inference.mixed_effects_linearised import (
    SharedBounds,
    centre_gram,
    find_nearest,
    hold_bounds,
)


@given(st.integers(0, 10_000))
def test_the_nearest_point_is_the_most_probable_within_bounds(seed):
    """Freed of its bound, a coordinate may be wanted inside again: no order of bounds is final."""
    rng = np.random.default_rng(seed)
    root = rng.normal(size=(4, 4)) + 0.2 * np.eye(4)
    covariance = root @ root.T
    mean = 2.0 * rng.normal(size=4)
    precision = np.linalg.inv(covariance)

    def lose(x):
        return (x - mean) @ precision @ (x - mean)

    found = find_nearest(mean, covariance, np.zeros(4), np.ones(4))
    rival = minimize(
        lambda x: (lose(x), 2.0 * precision @ (x - mean)),
        np.full(4, 0.5),
        jac=True,
        bounds=[(0.0, 1.0)] * 4,
        method="L-BFGS-B",
    )
    assert np.all((found >= 0.0) & (found <= 1.0))
    assert lose(found) <= rival.fun + 1e-6 * (1.0 + abs(rival.fun))


def test_a_coordinate_without_variance_takes_no_other_along():
    covariance = np.diag([1.0, -1e-30])
    found = find_nearest(np.array([-1.0, 2.0]), covariance, np.zeros(2), np.ones(2))
    np.testing.assert_array_equal(found, [0.0, 1.0])


def test_a_covariance_that_rounding_spoilt_has_a_nearest_point():
    """Its two coordinates seem correlated by more than 1."""
    covariance = np.array([[1.0, 1.0 + 1e-9], [1.0 + 1e-9, 1.0]])
    found = find_nearest(np.array([-1.0, -1.0]), covariance, np.zeros(2), np.ones(2))
    np.testing.assert_allclose(found, 0.0, atol=1e-6)


def test_own_parameters_and_their_mean_follow_a_held_one():
    """z = η + φ: what φ may not explain, η must."""
    rows = np.array([[1.0, 1.0, 5.0]]) * 100.0
    gram = np.tile(rows.T @ rows, (3, 1, 1))
    prior = Prior(np.zeros(2), np.array([1e-2, 1.0]), np.ones(1), 2.0, 1)
    own, shared = np.zeros((3, 1)), np.zeros(1)
    moved, near, centre = centre_gram(gram, prior, own, shared)
    linear = fit_linear(moved, near, np.eye(1))
    bounds = SharedBounds(np.array([-1.0]), np.array([0.01]), np.ones(1))
    held, target = hold_bounds(moved, near, bounds, linear, centre)
    assert target == 0.01
    np.testing.assert_allclose(held.own, 4.99, atol=1e-3)
    assert abs(held.shared[0] - 4.99) < 0.2
