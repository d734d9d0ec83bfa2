import numpy as np
import pytest
import xarray as xr

from softfinger.report.summaries import (
    flatten_variables,
    select_quantity,
    stack_population,
    summarise_hyperparameters,
    summarise_sampling,
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


def test_every_number_of_the_posterior_has_a_name_that_leads_back_to_it(posterior):
    names = flatten_variables(posterior.isel(chain=0, draw=0))
    assert "log_k_v[trial_002, 3]" in names
    draws = select_quantity(posterior, "log_k_v[trial_002, 3]")
    np.testing.assert_array_equal(
        draws, posterior["log_k_v"].sel(trial="trial_002", joint=3).transpose("chain", "draw")
    )


def test_the_chain_that_stands_apart_is_the_worst_quantity(posterior):
    apart = posterior.copy(deep=True)
    shifted = apart["mu_log_c_p"].values.copy()
    shifted[3, :, 1] += 5 * shifted[:, :, 1].std()
    apart["mu_log_c_p"] = (posterior["mu_log_c_p"].dims, shifted)
    sampling = summarise_sampling(apart)
    assert sampling["worst_quantity"].item() == "mu_log_c_p[2]"
    assert float(sampling["r_hat"].max()) > 1.5


def test_a_quantity_that_is_held_fixed_is_left_out(posterior):
    fixed = posterior.assign(held=xr.zeros_like(posterior["mu_q_ini"]))
    assert not any(
        str(name).startswith("held") for name in summarise_sampling(fixed)["quantity"].values
    )
