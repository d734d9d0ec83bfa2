import numpy as np
import pytest
import xarray as xr

from softfinger.summary.population import (
    gather_rivals,
    stack_population,
    summarise_correlations,
    summarise_effects,
    summarise_population,
)
from softfinger.summary.sampling import pick_worst_quantity, select_quantity


@pytest.fixture
def posterior(artifacts):
    return artifacts["posterior"]["posterior"].dataset


def test_quantiles_are_those_of_the_draws(posterior):
    summary = summarise_population(posterior, 0.8, {})
    draws = posterior["sigma_log_c_p"].sel(joint=2).values.ravel()
    here = summary.sel(statistic="sigma", parameter="c_p", joint=2)
    expected = np.quantile(draws, [0.1, 0.25, 0.5, 0.75, 0.9])
    np.testing.assert_allclose(here["quantile_value"], expected)
    assert float(here["sd"]) == pytest.approx(draws.std(ddof=1))


def test_centres_are_on_the_parameters_own_scale(posterior):
    summary = summarise_population(posterior, 0.9, {})
    k_v = np.exp(posterior["mu_log_k_v"].sel(joint=3).values)
    q_ini = posterior["mu_q_ini"].sel(joint=3).values
    assert float(summary["centre"].sel(parameter="k_v", joint=3)) == pytest.approx(np.median(k_v))
    assert float(summary["centre"].sel(parameter="q_ini", joint=3)) == pytest.approx(
        np.median(q_ini)
    )


def test_draws_of_the_population_keep_their_pairing(posterior):
    population = stack_population(posterior)
    assert population["mu"].dims == ("sample", "joint", "parameter")
    np.testing.assert_array_equal(
        population["mu"].sel(parameter="c_v", joint=1),
        posterior["mu_log_c_v"].sel(joint=1).values.ravel(),
    )


def test_rivals_are_brought_to_the_scale_of_the_centre(artifacts, posterior):
    rivals = gather_rivals(artifacts["least_squares"], like_the_paper=True)
    summary = summarise_population(posterior, 0.9, rivals)
    assert summary["rival"].values.tolist() == ["two_stage", "paper"]
    paper = summary["rival_centre"].sel(rival="paper", parameter="k_v", joint=1)
    assert float(paper) == pytest.approx(np.exp(-2.4441))
    mean = artifacts["least_squares"]["population_mean"].sel(parameter="q_ini", joint=2)
    shown = summary["rival_centre"].sel(rival="two_stage", parameter="q_ini", joint=2)
    assert float(shown) == pytest.approx(float(mean))


def test_a_spread_that_is_hardly_determined_is_marked(posterior):
    wide = posterior.assign(sigma_q_ini=posterior["sigma_q_ini"].copy(deep=True))
    wide["sigma_q_ini"].values[:, ::2, 1] *= 9.0
    unsure = summarise_population(wide, 0.9, {})["unsure"]
    assert unsure.sel(parameter="q_ini").values.tolist() == [False, True, False]


def test_effects_are_summed_up_on_their_own_scale(posterior):
    drawn = np.random.default_rng(3).normal([2.0, 0.5], 0.1, (4, 60, 2))
    labels = ["gravity.load", "gravity.share"]
    effect = xr.Variable(("chain", "draw", "effect_parameter"), drawn)
    found = summarise_effects(
        posterior.assign(effect=effect).assign_coords(effect_parameter=labels), 0.9
    )
    np.testing.assert_allclose(found["effect_mean"], drawn.mean((0, 1)))
    middle = found["effect_quantile"].sel(quantile=0.5)
    np.testing.assert_allclose(middle, np.median(drawn, (0, 1)))


def test_the_surest_correlation_comes_first_and_held_ones_are_left_out(posterior):
    rng = np.random.default_rng(1)
    matrix = np.zeros((4, 60, 3, 3)) + np.eye(3)
    for a, b, centre in ((0, 1, 0.05), (2, 1, -0.8)):
        matrix[..., a, b] = matrix[..., b, a] = centre + 0.1 * rng.standard_normal((4, 60))
    own = ["log_k_v[1]", "log_c_v[1]", "q_ini[1]"]
    variable = xr.Variable(("chain", "draw", "own", "other_own"), matrix)
    drawn = xr.Dataset({"parameter_correlation": variable}, {"own": own, "other_own": own})
    found = summarise_correlations(drawn, 0.9)
    assert found["one"].values.tolist() == ["log_c_v[1]", "log_k_v[1]"]
    assert found["other"].values.tolist() == ["q_ini[1]", "log_c_v[1]"]
    assert found["clear"].values.tolist() == [True, False]
    assert float(found["by_chance"]) == pytest.approx(0.2)


def test_the_hyperparameter_whose_chains_agree_least_is_picked(artifacts, posterior):
    found = pick_worst_quantity(artifacts["sampling"], posterior)
    assert found["worst_quantity"].item() == "mu_log_k_v[1]"
    draws = posterior["mu_log_k_v"].sel(joint=1).values
    expected = (draws - draws.mean()) / draws.std()
    np.testing.assert_allclose(found["worst_draws"], expected)
    np.testing.assert_allclose(found["running_mean"][:, -1], expected.mean(axis=1))


def test_a_quantity_is_found_by_its_name(posterior):
    both = ("chain", "draw", "joint", "other_joint")
    square = np.arange(4 * 60 * 9.0).reshape(4, 60, 3, 3)
    wide = posterior.assign(noise_correlation=(both, square)).assign_coords(other_joint=[1, 2, 3])
    draws = select_quantity(wide, "noise_correlation[3, 1]")
    np.testing.assert_array_equal(draws, square[:, :, 2, 0])
    draws = select_quantity(wide, "sigma_log_c_p[2]")
    np.testing.assert_array_equal(draws, posterior["sigma_log_c_p"].sel(joint=2))
