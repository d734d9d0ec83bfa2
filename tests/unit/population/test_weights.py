import numpy as np
import pytest

from softfinger.population.covariance import (
    compute_innovation_covariance_array,
    correlate_partials_array,
)
from softfinger.population.weights import pull_weights_back, weigh_noise

GAP = np.array([1.0, 2.5])
SD = np.array([0.9, 1.2, 0.7])
RHO = np.array([0.3, 0.8, 0.5])
CORRELATION = correlate_partials_array(np.array([-0.5, 0.1, -0.4]))
PATTERNS = np.array([[True, True, True], [True, False, True]])


def test_weights_are_those_of_the_residuals_gains():
    weights = weigh_noise(GAP, PATTERNS, SD, RHO, CORRELATION)
    rng = np.random.default_rng(0)
    before, now = rng.standard_normal((2, 3))
    covariance = compute_innovation_covariance_array(2.5, SD, RHO, CORRELATION)
    gain = now - RHO**2.5 * before
    w0, w1, w2 = weights.pair[0, 1]
    found = now @ w0 @ now + before @ w1 @ before + before @ w2 @ now
    assert found == pytest.approx(gain @ np.linalg.solve(covariance, gain))
    assert weights.logdet[0, 1] == pytest.approx(np.linalg.slogdet(covariance)[1])
    stationary = compute_innovation_covariance_array(np.inf, SD, RHO, CORRELATION)
    assert weights.precision[0, 2] == pytest.approx(np.linalg.inv(stationary))


def test_an_absent_joint_weighs_nothing_and_the_others_as_if_alone():
    weights = weigh_noise(GAP, PATTERNS, SD, RHO, CORRELATION)
    some = [0, 2]
    alone = weigh_noise(
        GAP, np.ones((1, 2), bool), SD[some], RHO[some], CORRELATION[np.ix_(some, some)]
    )
    assert weights.pair[1][..., some, :][..., some] == pytest.approx(alone.pair[0])
    assert (weights.pair[1][..., 1, :] == 0).all()
    assert weights.logdet[1] == pytest.approx(alone.logdet[0])


def test_slopes_are_those_of_differences():
    rng = np.random.default_rng(5)
    pair_bar = rng.standard_normal((2, 2, 3, 3, 3))
    first_bar, logdet_bar = rng.standard_normal((2, 3, 3)), rng.standard_normal((2, 3))

    def value(sd, rho, correlation):
        weights = weigh_noise(GAP, PATTERNS, sd, rho, correlation)
        total = (weights.pair * pair_bar).sum() + (weights.logdet * logdet_bar).sum()
        return total + (weights.precision[:, -1] * first_bar).sum()

    precision = weigh_noise(GAP, PATTERNS, SD, RHO, CORRELATION).precision
    found = pull_weights_back(GAP, SD, RHO, CORRELATION, precision, pair_bar, first_bar, logdet_bar)
    step = 1e-6
    for k, unit in enumerate(np.eye(3)):
        up, down = (
            value(SD + step * unit, RHO, CORRELATION),
            value(SD - step * unit, RHO, CORRELATION),
        )
        assert found[0][k] == pytest.approx((up - down) / (2 * step), rel=1e-5)
        up, down = (
            value(SD, RHO + step * unit, CORRELATION),
            value(SD, RHO - step * unit, CORRELATION),
        )
        assert found[1][k] == pytest.approx((up - down) / (2 * step), rel=1e-5)
    turn = np.zeros((3, 3))
    turn[0, 2] = turn[2, 0] = 1.0
    up, down = value(SD, RHO, CORRELATION + step * turn), value(SD, RHO, CORRELATION - step * turn)
    assert (found[2] * turn).sum() == pytest.approx((up - down) / (2 * step), rel=1e-5)
