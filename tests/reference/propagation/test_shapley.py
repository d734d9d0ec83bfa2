"""Shapley effects against the Sobol indices without correlation, and against sampling with it."""

from itertools import permutations

import numpy as np
import pytest

from softfinger.faults import Fault
from softfinger.inference.motion import move_paper_joint
from softfinger.propagation.correlated import compute_values_array
from softfinger.propagation.independent import share_variance_array
from softfinger.propagation.subsets import (
    EVERY,
    SUBSETS,
    compute_shapley_effects,
    compute_sobol_indices,
)

MU = np.array([-2.4441, -3.6635, 2.8538, 0.02])
SIGMA = np.array([0.1973, 0.5232, 0.7011, 0.03])
FACTOR = np.array(
    [[1.0, 0.0, 0.0, 0.0], [0.8, 1.0, 0.0, 0.0], [-0.5, 0.3, 1.0, 0.0], [0.6, -0.2, 0.7, 1.0]]
)
FACTOR /= np.linalg.norm(FACTOR, axis=1, keepdims=True)
COVARIANCE = FACTOR @ FACTOR.T * np.outer(SIGMA, SIGMA)
TIME = np.array([0.0, 0.2, 1.0, 10.0])
LOAD = np.array([[0.0, 0.5, 4.0, 4.0], [0.0, 0.04, 0.04, 0.01]])


def compute_effects(mu, covariance, time, *load):
    _, value = compute_values_array(mu[None], covariance, time, *load)
    return compute_shapley_effects({u: v[0] / value[EVERY][0] for u, v in value.items()})


def test_without_correlation_half_of_an_interaction_goes_to_each():
    effect = compute_effects(MU, np.diag(SIGMA**2), TIME, *LOAD)
    indices = compute_sobol_indices(share_variance_array(MU, SIGMA, TIME, *LOAD))
    expected = (indices.first_order + indices.total) / 2
    np.testing.assert_allclose(effect, expected, atol=1e-9)


def test_effects_of_correlated_parameters_are_shares():
    effect = compute_effects(MU, COVARIANCE, TIME, *LOAD)
    np.testing.assert_allclose(effect.sum(axis=-1), 1.0, rtol=1e-12)
    assert (effect >= 0).all()


def sample_value(covariance, subset, n, rng):
    """v(u) by two copies of the parameters that share u, through the plain forward model."""
    u = list(subset)
    gain = covariance[:, u] @ np.linalg.inv(covariance[np.ix_(u, u)])
    left = covariance - gain @ covariance[u]
    shared = rng.multivariate_normal(np.zeros(4), covariance, n)[:, u] @ gain.T
    copies = []
    for _ in range(2):
        x = MU + shared + rng.multivariate_normal(np.zeros(4), left, n, method="eigh")
        copies.append(move_paper_joint(x[:, None], None, None, TIME, *LOAD)[:, 0])
    centred = [copy - copy.mean(axis=0) for copy in copies]
    return (centred[0] * centred[1]).mean(axis=0)


def test_effects_of_correlated_parameters_agree_with_sampled_ones():
    rng = np.random.default_rng(11)
    value = {subset: sample_value(COVARIANCE, subset, 8000, rng) for subset in SUBSETS}
    value[()] = np.zeros(TIME.size)
    effect = compute_effects(MU, COVARIANCE, TIME, *LOAD)
    orders = list(permutations(range(4)))
    sampled = np.zeros((TIME.size, 4))
    for order in orders:
        for place, player in enumerate(order):
            before = tuple(sorted(order[:place]))
            after = tuple(sorted(order[: place + 1]))
            sampled[:, player] += (value[after] - value[before]) / len(orders)
    sampled /= value[(0, 1, 2, 3)][:, None]
    np.testing.assert_allclose(effect, sampled, atol=0.05)


def test_two_parameters_that_always_go_together_share_alike():
    """q_ini and log c_p, correlated to 0.999, before the load: either tells the other."""
    covariance = np.diag(SIGMA**2)
    covariance[2, 3] = covariance[3, 2] = 0.999 * SIGMA[2] * SIGMA[3]
    effect = compute_effects(MU, covariance, [0.0], *LOAD)[0]
    np.testing.assert_allclose(effect, [0, 0, 0.5, 0.5], atol=2e-3)


def test_an_impossible_covariance_is_refused():
    covariance = np.diag(SIGMA**2)
    covariance[0, 1] = covariance[1, 0] = 1.1 * SIGMA[0] * SIGMA[1]
    with pytest.raises(Fault, match="positive definite"):
        compute_effects(MU, covariance, TIME, *LOAD)
