import numpy as np
import pytest

from softfinger.measurement.covariance import (
    compute_innovation_covariance_array,
    correlate_partials_array,
    factorise_partials,
    pull_factor_back,
)

PARTIAL = np.array([-0.5, 0.2, 0.7, -0.1, 0.4, -0.6])


def test_partials_make_a_correlation_matrix():
    correlation = correlate_partials_array(PARTIAL)
    assert np.diag(correlation) == pytest.approx(1.0)
    assert np.linalg.eigvalsh(correlation).min() > 0
    assert correlation[0, 1] == pytest.approx(PARTIAL[0])  # no other joint lies between


def test_one_joint_has_no_partials():
    assert correlate_partials_array(np.empty((2, 5, 0))).shape == (2, 5, 1, 1)


def test_slope_by_partials_is_that_of_differences():
    seed = np.random.default_rng(2).standard_normal((4, 4))

    def value(partial):
        return (correlate_partials_array(partial) * seed).sum()

    step = 1e-6
    slope = [
        (value(PARTIAL + step * unit) - value(PARTIAL - step * unit)) / (2 * step)
        for unit in np.eye(6)
    ]
    factor = factorise_partials(PARTIAL)
    found = pull_factor_back(PARTIAL, factor, (seed + seed.T) @ factor)
    assert found == pytest.approx(slope, rel=1e-6)


def test_two_steps_are_one_step_twice():
    sd, rho = np.array([1.0, 2.0]), np.array([0.9, 0.4])
    correlation = correlate_partials_array(np.array([-0.5]))
    once = compute_innovation_covariance_array(1.0, sd, rho, correlation)
    twice = compute_innovation_covariance_array(2.0, sd, rho, correlation)
    assert twice == pytest.approx(once + np.outer(rho, rho) * once)
    for_ever = compute_innovation_covariance_array(np.inf, sd, rho, correlation)
    assert for_ever == pytest.approx(once + np.outer(rho, rho) * for_ever)
    assert np.diag(for_ever) == pytest.approx(sd**2)
