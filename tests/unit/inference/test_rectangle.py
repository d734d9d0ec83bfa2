import numpy as np
import pytest
from scipy.stats import multivariate_normal, norm

from softfinger.inference.rectangle import cut_normal, measure_rectangle

OPEN = np.full(3, np.inf)


@pytest.mark.parametrize(("mean", "sd"), [(0.0, 1.0), (-3.0, 0.5), (-40.0, 1.0), (10.0, 2.0)])
def test_one_number_is_exact(mean, sd):
    found = measure_rectangle(np.array([mean]), np.array([[sd**2]]), np.zeros(1), OPEN[:1])
    assert found == pytest.approx(norm.logsf(0.0, mean, sd), rel=1e-9)


@pytest.mark.parametrize("seed", range(6))
def test_an_orthant_of_correlated_numbers(seed):
    rng = np.random.default_rng(seed)
    root = rng.normal(size=(3, 3))
    covariance, mean = root @ root.T + 0.3 * np.eye(3), rng.normal(-1.0, 1.5, 3)
    exact = np.log(multivariate_normal(-mean, covariance).cdf(np.zeros(3)))
    assert measure_rectangle(mean, covariance, np.zeros(3), OPEN) == pytest.approx(exact, abs=0.02)


def test_numbers_that_pull_apart_hardly_lie_both_inside():
    pair = np.array([[1.0, -0.5], [-0.5, 1.0]])
    far = np.full(2, -5.0)
    apart = 2 * norm.logsf(5.0)
    assert measure_rectangle(far, pair, np.zeros(2), OPEN[:2]) < apart - 10.0


def test_no_number_is_certainly_inside():
    assert measure_rectangle(np.empty(0), np.empty((0, 0)), np.empty(0), np.empty(0)) == 0.0


@pytest.mark.parametrize("centre", [-2.0, 0.3, 4.0])
def test_moments_between_bounds(centre):
    rng = np.random.default_rng(2)
    drawn = rng.normal(centre, 1.5, 4_000_000)
    drawn = drawn[(drawn > -1.0) & (drawn < 2.0)]
    mass, mean, variance = cut_normal(centre, 1.5**2, -1.0, 2.0)
    assert np.exp(mass) == pytest.approx(drawn.size / 4e6, rel=0.01)
    assert mean == pytest.approx(drawn.mean(), abs=0.01)
    assert variance == pytest.approx(drawn.var(), rel=0.02)


def test_far_in_the_tail_what_is_left_is_exponential():
    mass, mean, variance = cut_normal(-50.0, 1.0, 0.0, np.inf)
    assert mass == pytest.approx(norm.logsf(50.0), rel=1e-6)
    assert mean == pytest.approx(1 / 50, rel=0.01)
    assert variance == pytest.approx(1 / 50**2, rel=0.01)


def test_numbers_without_bounds_and_without_freedom_do_not_matter():
    """A law of one term less than it has coefficients ended a diagnosis with an error."""
    root = np.random.default_rng(3).normal(size=(2, 2))
    pair, mean = root @ root.T, np.array([0.4, -0.2])
    low, high = np.array([0.0, -1.0]), np.array([np.inf, 0.5])
    known = measure_rectangle(mean, pair, low, high)
    wide = np.array([[1.0, 0.0], [0.0, 1.0], [1.0, 2.0]])  # the third is made of the others
    full, free = wide @ pair @ wide.T, np.array([np.inf])
    found = measure_rectangle(wide @ mean, full, np.append(low, -free), np.append(high, free))
    assert found == pytest.approx(known, abs=1e-9)
    twice = np.kron(np.ones((2, 2)), pair[:1, :1])
    assert np.isfinite(measure_rectangle(mean[[0, 0]], twice, low[[0, 0]], high[[0, 0]]))
