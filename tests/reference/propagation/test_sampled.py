"""Sampled shares of the variance against closed forms, of independent and of dependent inputs."""

import numpy as np
import pytest
import xarray as xr
from scipy.special import ndtr

from softfinger.propagation.config import PropagationConfig
from softfinger.propagation.new_trials import Source
from softfinger.propagation.protocols import Protocol
from softfinger.propagation.sampled import share_variance
from softfinger.propagation.subsets import (
    EVERY,
    compute_shapley_effects,
    compute_sobol_indices,
)

PROTOCOL = Protocol("protocol_1", np.array([0]), np.array([0.0]), np.array([1.0]), 1.0)
TIME = np.array([0.0])
KNOBS = {
    "draws": 16, "sampled_draws": 16, "draw_samples": 1024, "band_samples": 64, "band_times": 2,
    "sobol_time_step_s": 1.0, "running_times_s": [1.0], "density_times_s": [1.0],
    "density_angles": 2, "c_p_truncation_sd": None,
}  # fmt: skip


def share(function, correlation=None):
    """Mean shares over 16 independent runs of a function of four standard normal numbers."""
    correlation = np.eye(4) if correlation is None else correlation
    population = xr.Dataset(
        {
            "mu": (("draw", "joint", "parameter"), np.zeros((16, 1, 4))),
            "sigma": (("draw", "joint", "parameter"), np.ones((16, 1, 4))),
            "correlation": (("draw", "own", "other_own"), np.tile(correlation, (16, 1, 1))),
        }
    )

    def move(own, *_):
        return function(own[:, 0])[:, None, None]

    source = Source(population, move, PropagationConfig(**KNOBS), 7)
    found = share_variance(source, PROTOCOL, TIME)
    return {subset: value.mean(axis=0)[0, 0] for subset, value in found.items()}


def test_ishigami():
    """Closed form: Ishigami, Homma (1990), a = 7, b = 0.1; the fourth number does nothing."""
    a, b = 7.0, 0.1

    def function(normal):
        x = np.pi * (2 * ndtr(normal) - 1)
        return np.sin(x[:, 0]) * (1 + b * x[:, 2] ** 4) + a * np.sin(x[:, 1]) ** 2

    v1 = 0.5 * (1 + b * np.pi**4 / 5) ** 2
    v2, v13 = a**2 / 8, b**2 * np.pi**8 * (1 / 18 - 1 / 50)
    whole = v1 + v2 + v13
    indices = compute_sobol_indices(share(function))
    np.testing.assert_allclose(indices.first_order, np.array([v1, v2, 0, 0]) / whole, atol=0.02)
    np.testing.assert_allclose(indices.total, np.array([v1 + v13, v2, v13, 0]) / whole, atol=0.02)
    assert indices.second_order[1] == pytest.approx(v13 / whole, abs=0.03)


def test_sobol_g():
    """Closed form: V_i = 1/(3 (1 + a_i)²), ∏(1 + V_i) − 1 in all."""
    a = np.array([0.0, 0.5, 3.0, 9.0])
    part = 1 / (3 * (1 + a) ** 2)
    whole = (1 + part).prod() - 1
    found = share(lambda normal: ((np.abs(4 * ndtr(normal) - 2) + a) / (1 + a)).prod(axis=1))
    indices = compute_sobol_indices(found)
    np.testing.assert_allclose(indices.first_order, part / whole, atol=0.02)
    total = part * (1 + part).prod() / (1 + part) / whole
    np.testing.assert_allclose(indices.total, total, atol=0.02)


def test_a_sum_of_dependent_numbers():
    """Closed form for β·x, x ~ N(0, R): v(u) = β' R_·u R_uu⁻¹ R_u· β; Owen, Prieur (2017)."""
    weight = np.array([1.0, 2.0, -1.0, 0.5])
    factor = np.array([[1, 0, 0, 0], [0.8, 1, 0, 0], [-0.5, 0.3, 1, 0], [0.6, -0.2, 0.7, 1]])
    factor /= np.linalg.norm(factor, axis=1, keepdims=True)
    correlation = factor @ factor.T
    found = share(lambda x: x @ weight, correlation)
    exact = {}
    for subset in found:
        u = list(subset)
        gain = correlation[:, u] @ np.linalg.inv(correlation[np.ix_(u, u)])
        exact[subset] = weight @ gain @ correlation[u] @ weight
    exact = {subset: value / exact[EVERY] for subset, value in exact.items()}
    for subset, value in found.items():
        assert value == pytest.approx(exact[subset], abs=0.02)
    np.testing.assert_allclose(
        compute_shapley_effects(found), compute_shapley_effects(exact), atol=0.02
    )
    assert exact[0,] > 1 - exact[1, 2, 3]  # with what goes along, more than alone


def test_what_does_not_vary_has_no_shares():
    assert np.isnan(share(lambda x: 0 * x[:, 0])[0,])
