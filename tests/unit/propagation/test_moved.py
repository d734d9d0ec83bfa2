"""Samples of any forward model against the exact routes of the paper's joint."""

import numpy as np
import pytest
import xarray as xr

from softfinger.mechanics.three_element import compute_joint_angle_array
from softfinger.propagation.config import read_config
from softfinger.propagation.indices import compute_sobol_array
from softfinger.propagation.moments import compute_moments_array
from softfinger.propagation.moved import (
    draw_normal_array,
    estimate_densities_array,
    estimate_indices,
    estimate_shrinkage,
    predict_moved,
)
from softfinger.propagation.protocols import Protocol

TIME = np.array([0.1, 1.0, 4.0])
LOAD = np.array([0.0, 6.0]), np.array([0.04, 0.04])
PROTOCOL = Protocol("protocol_1", np.array([0, 2]), *LOAD, 6.0)
MU = np.array([[-2.4, -3.6, 2.8, 0.02], [-1.9, -3.2, 3.3, 0.03]])
SIGMA = np.array([[0.2, 0.5, 0.7, 0.01], [0.3, 0.6, 0.5, 0.02]])


@pytest.fixture
def population():
    draws = np.array([0.0, 0.01, -0.01, 0.02, -0.02])[:, None, None]
    return xr.Dataset(
        {
            "mu": (("draw", "joint", "parameter"), MU + draws),
            "sigma": (("draw", "joint", "parameter"), np.tile(SIGMA, (5, 1, 1))),
            "noise_sd": (("draw", "joint"), np.full((5, 2), 0.003)),
        },
        coords={"joint": [1, 2], "parameter": ["k_v", "c_v", "c_p", "q_ini"]},
    )


def move(own, draw, like, time, load_time, load_torque):
    """The paper's joint; draws and trials make no difference."""
    assert draw.max() < 5
    assert set(like) <= {0, 2}
    natural = [*np.exp(np.moveaxis(own[..., :3], -1, 0)), own[..., 3]]
    return compute_joint_angle_array(*natural, time, load_time, load_torque)


def test_moments_and_quantiles_of_new_trials(population, config):
    rng = np.random.default_rng(1)
    found, samples = predict_moved(move, population, PROTOCOL, TIME, read_config(config), rng)
    mean, variance = compute_moments_array(MU, SIGMA, TIME, *LOAD, None)
    np.testing.assert_allclose(found["joint_angle_mean"], mean, rtol=0.02)
    np.testing.assert_allclose(found["joint_angle_sd"], np.sqrt(variance), rtol=0.1)
    quantile = found["predicted_quantile"].values
    assert (np.diff(quantile, axis=-1) > 0).all()
    assert samples[1].ordered.shape == (3, len(samples[1].draw))


def test_indices_are_those_of_the_exact_route(population):
    rng = np.random.default_rng(2)
    found = estimate_indices(population, move, PROTOCOL, TIME, rng, None)
    exact = compute_sobol_array(MU, SIGMA, TIME, *LOAD, None)
    np.testing.assert_allclose(found["first_order"].mean("draw"), exact.first_order, atol=0.06)
    np.testing.assert_allclose(found["total"].mean("draw"), exact.total, atol=0.06)


def test_a_parameter_without_spread_shrinks_nothing(population):
    still = population.copy(deep=True)
    still["sigma"][..., 2] = 0.0
    found = estimate_shrinkage(still, move, PROTOCOL, [4.0, 1.0], np.random.default_rng(3), None)
    shrinkage = found["spread_shrinkage"]
    np.testing.assert_allclose(shrinkage.sel(parameter="c_p"), 0.0, atol=1e-12)
    removed, halved = (shrinkage.sel(change=c, parameter="k_v") for c in ("removed", "halved"))
    assert (removed > halved).all()


def test_a_cut_population_stays_inside():
    normal = draw_normal_array((2, 64, 3), np.random.default_rng(4), 1.5)
    assert normal.shape == (2, 64, 3, 4)
    assert np.abs(normal[..., 2]).max() <= 1.5
    assert np.abs(normal[..., 0]).max() > 1.5


def test_a_kernel_density_holds_one():
    sample = np.random.default_rng(5).normal(0.3, 0.05, (2, 400, 1))
    places = np.linspace(0.0, 0.6, 200)[None]
    density = estimate_densities_array(sample, places)
    np.testing.assert_allclose(np.trapezoid(density, places, axis=-1), 1.0, atol=1e-3)
    middle = density[:, 0, np.argmin(np.abs(places[0] - 0.3))]
    np.testing.assert_allclose(middle, 1 / (0.05 * np.sqrt(2 * np.pi)), rtol=0.15)
