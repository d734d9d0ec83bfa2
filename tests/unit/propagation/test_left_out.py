"""Importance weights against what they stand for: estimates made without the trial."""

import numpy as np
import pytest
import xarray as xr

from softfinger.propagation.left_out import build_posterior_weights, build_two_stage_weights
from softfinger.propagation.new_trials import (
    NewTrials,
    order_samples_array,
    take_quantiles_array,
)
from softfinger.propagation.populations import select_posterior

NAMES = ("log_k_v", "log_c_v", "log_c_p", "q_ini")


def make_samples(location, draw):
    nothing = np.empty((0, len(location)))
    return NewTrials(location, draw, nothing, nothing.astype(int))


def test_two_stage_weights_turn_the_population_into_that_of_the_others(least_squares):
    trial = least_squares["trial"]
    weigh = build_two_stage_weights(least_squares, trial)
    rng = np.random.default_rng(1)
    mean = least_squares["population_mean"].sel(joint=2).to_numpy()
    sd = least_squares["population_sd"].sel(joint=2).to_numpy()
    location = mean + sd * rng.standard_normal((200000, 4))
    weight = weigh(4, 1, make_samples(location, np.zeros(200000, int)))
    others = least_squares["estimate"].isel(trial=[0, 1, 2, 3, 5, 6], joint=1).to_numpy()
    others[:, :3] = np.log(others[:, :3])
    found = weight @ location
    np.testing.assert_allclose(found, others.mean(axis=0), atol=0.02 * np.abs(sd).max())
    spread = np.sqrt(weight @ (location - found) ** 2)
    np.testing.assert_allclose(spread, others.std(axis=0, ddof=1), rtol=0.03)


def test_a_dropped_estimate_took_no_part(least_squares):
    least_squares["kept"][2] = False
    weigh = build_two_stage_weights(least_squares, least_squares["trial"])
    weight = weigh(2, 0, make_samples(np.zeros((8, 4)), np.zeros(8, int)))
    np.testing.assert_allclose(weight, 1 / 8, rtol=1e-12)


def test_too_few_others_predict_nothing(least_squares):
    least_squares["kept"][2:] = False
    weigh = build_two_stage_weights(least_squares, least_squares["trial"])
    assert np.isnan(weigh(0, 0, make_samples(np.zeros((8, 4)), np.zeros(8, int)))).all()


def correlate_two(one, other, by):
    matrix = np.eye(8)
    matrix[one, other] = matrix[other, one] = by
    return matrix


@pytest.mark.parametrize(
    "correlation", [np.eye(8), correlate_two(0, 2, 0.8), correlate_two(1, 6, 0.8)]
)
def test_posterior_weights_take_a_trial_out_of_a_conjugate_posterior(correlation):
    """Known parameters, known Ω, flat prior: μ | x ~ N(mean, Ω/n), and so without the trial."""
    rng = np.random.default_rng(4)
    n, draws, sigma = 8, 100000, np.tile([0.2, 0.5, 0.7, 0.01], 2)
    root = sigma[:, None] * np.linalg.cholesky(correlation)
    own = 1.0 + rng.standard_normal((n, 8)) @ root.T
    mu = own.mean(axis=0) + rng.standard_normal((draws, 8)) @ root.T / np.sqrt(n)
    dims = ("chain", "draw", "joint")
    data = dict.fromkeys(
        ["noise_sd", "noise_autocorrelation", "noise_white"], (dims, np.ones((1, draws, 2)))
    )
    for place, name in enumerate(NAMES):
        data[f"mu_{name}"] = (dims, mu[None, :, place::4])
        data[f"sigma_{name}"] = (dims, np.full((1, draws, 2), sigma[place]))
        value = np.broadcast_to(own[:, place::4], (1, draws, n, 2))
        data[name] = (("chain", "draw", "trial", "joint"), value)
    whole = np.broadcast_to(correlation, (1, draws, 8, 8))
    data["parameter_correlation"] = (("chain", "draw", "own", "other_own"), whole)
    trial = [f"trial_{i}" for i in range(n)]
    tree = xr.DataTree.from_dict({"posterior": xr.Dataset(data, coords={"trial": trial})})
    population = select_posterior(tree, draws)
    names = xr.DataArray([*trial, "unknown"], dims="trial")
    weigh = build_posterior_weights(tree, population, names)
    samples = make_samples(np.zeros((draws, 4)), np.arange(draws))
    expected = np.delete(own, 1, axis=0).mean(axis=0)
    for joint in (0, 1):
        block = slice(4 * joint, 4 * joint + 4)
        found = weigh(1, joint, samples) @ population["mu"].to_numpy()[:, joint]
        np.testing.assert_allclose((found - expected[block]) / sigma[block], 0, atol=0.03)
        np.testing.assert_allclose(weigh(n, joint, samples), 1 / draws, rtol=1e-12)


def test_even_weights_give_plain_quantiles():
    values, probability = (
        np.random.default_rng(3).standard_normal((2, 5)),
        np.array([0.02, 0.3, 0.93]),
    )
    ours = take_quantiles_array(*order_samples_array(values), np.full(5, 0.2), probability)
    expected = np.quantile(values, probability, axis=1, method="hazen").T
    np.testing.assert_allclose(ours, expected)


def test_a_value_of_no_weight_does_not_count():
    values = np.array([[3.0, 1.0, 9.0, 2.0]])
    weight = np.array([0.25, 0.25, 0.0, 0.5])
    ours = take_quantiles_array(*order_samples_array(values), weight, np.array([0.125, 0.5, 0.875]))
    np.testing.assert_allclose(ours, [[1.0, 2.0, 3.0]])
