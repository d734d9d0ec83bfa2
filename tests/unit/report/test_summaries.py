import numpy as np
import pytest

from softfinger.report.summaries import (
    select_quantity,
    stack_population,
    summarise_hyperparameters,
    summarise_trial_parameters,
)


@pytest.fixture
def posterior(artifacts):
    return artifacts["posterior"]["posterior"].dataset


def test_quantiles_are_those_of_the_draws(posterior):
    summary = summarise_hyperparameters(posterior, 0.8)
    draws = posterior["sigma_log_c_p"].sel(joint=2).values.ravel()
    here = summary.sel(statistic="sigma", parameter="c_p", joint=2)
    expected = np.quantile(draws, [0.1, 0.25, 0.5, 0.75, 0.9])
    np.testing.assert_allclose(here["quantile_value"], expected)
    assert float(here["sd"]) == pytest.approx(draws.std(ddof=1))


def test_centres_are_on_the_parameters_own_scale(posterior):
    summary = summarise_hyperparameters(posterior, 0.9)
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


def test_trial_parameters_are_at_the_mean_of_their_logs(posterior):
    own = summarise_trial_parameters(posterior)
    expected = np.exp(posterior["log_c_v"].mean(("chain", "draw")))
    np.testing.assert_allclose(own["c_v"], expected.transpose("trial", "joint"))


def test_a_quantity_is_found_by_its_name(posterior):
    both = ("chain", "draw", "joint", "other_joint")
    square = np.arange(4 * 60 * 9.0).reshape(4, 60, 3, 3)
    wide = posterior.assign(noise_correlation=(both, square)).assign_coords(other_joint=[1, 2, 3])
    draws = select_quantity(wide, "noise_correlation[3, 1]")
    np.testing.assert_array_equal(draws, square[:, :, 2, 0])
    draws = select_quantity(wide, "sigma_log_c_p[2]")
    np.testing.assert_array_equal(draws, posterior["sigma_log_c_p"].sel(joint=2))
