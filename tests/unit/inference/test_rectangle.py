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
