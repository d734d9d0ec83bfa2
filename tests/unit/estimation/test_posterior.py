"""The hierarchical posterior: its groups, its truth, its repeatability, trials left out."""

import numpy as np

from softfinger.artifacts.spec import list_tree_faults
from softfinger.artifacts.specs.posterior import SPEC
from softfinger.estimation import diagnose_sampling
from softfinger.estimation.leave_out import forget_trial, keep_trial
from softfinger.estimation.posterior import compile_fit, prepare_fit, sample_posterior
from softfinger.population.likelihood import compute_log_likelihood_array

NAMES = ("log_k_v", "log_c_v", "log_c_p", "q_ini")
SMALL = {
    "chains": 2,
    "tune": 200,
    "draws": 150,
    "cores": 1,
    "target_accept": 0.8,
    "max_depth": 10,
    "sampler": "nuts",
    "covariance": "independent",
}


def stack_trials(own):
    return np.stack([np.log(own[k]) for k in ("k_v", "c_v", "c_p")] + [own["q_ini"]], axis=-1)


def test_groups_are_arviz_s(tree):
    expected = {
        "posterior", "sample_stats", "prior", "prior_predictive", "posterior_predictive",
        "log_likelihood", "leave_one_out", "loo_pit", "independence", "prior_sensitivity",
        "observed_data", "constant_data",
    }  # fmt: skip
    assert set(tree.children) == expected
    posterior = tree["posterior"].dataset
    assert posterior["mu_log_k_v"].dims == ("chain", "draw", "joint")
    assert posterior["log_c_p"].sizes == {"chain": 4, "draw": 250, "trial": 7, "joint": 2}


def test_every_group_is_as_declared(tree):
    assert list_tree_faults(SPEC, tree) == []
    bare = tree.copy()
    del bare["independence"], bare["prior_sensitivity"], bare["loo_pit"]
    assert list_tree_faults(SPEC, bare) == []


def test_the_sampling_passes_and_can_fail(tree):
    config = {"r_hat_max": 1.05, "ess_min": 100.0, "divergences_max": 0}
    assert diagnose_sampling(tree, config).attrs["verdict"] == "green"
    assert diagnose_sampling(tree, config | {"ess_min": 1e6}).attrs["verdict"] == "red"


def test_trials_are_found_within_their_uncertainty(tree, campaign):
    true = stack_trials(campaign[1])
    draws = np.stack([tree["posterior"][name].values for name in NAMES], axis=-1)
    draws = draws.reshape(-1, *true.shape)
    z = (draws.mean(axis=0) - true) / draws.std(axis=0)
    assert 0.6 < np.sqrt((z**2).mean()) < 1.4  # 56 of them: rms 1 ± 0.1


def test_the_noise_is_found(tree):
    posterior = tree["posterior"].dataset
    for name, true, tolerance in (("noise_sd", 0.002, 2e-4), ("noise_autocorrelation", 0.3, 0.1)):
        np.testing.assert_allclose(posterior[name].mean(("chain", "draw")), true, atol=tolerance)


def test_the_same_draws_on_one_core_and_two(campaign):
    prepared = prepare_fit(campaign[0])
    density = compile_fit(prepared, SMALL)
    one, two = (
        sample_posterior(
            prepared, SMALL | {"tune": 20, "draws": 20, "cores": n},
            np.random.default_rng(1), density,
        )[0]
        for n in (1, 2)
    )  # fmt: skip
    assert one.identical(two)


def test_every_trial_is_left_out(tree):
    scores = tree["leave_one_out"].dataset
    assert np.isfinite(scores["elpd"]).all()
    assert (scores["refitted"] == (scores["pareto_k"] > 0.7)).all()


def test_own_trials_lie_anywhere_in_what_the_others_predict(tree):
    found = tree["loo_pit"].dataset
    assert found["pit"].sizes == {"trial": 7, "joint": 2, "moment": 4}
    assert ((found["pit"] > 0) & (found["pit"] < 1)).all()
    assert found["smallest_p"] > 0.01


def test_a_forgotten_trial_has_the_population_s_parameters(campaign):
    prepared = prepare_fit(campaign[0])
    less, pilot = forget_trial(prepared.collapse, prepared.pilot, prepared.prior, 2)
    left = prepared._replace(collapse=less, pilot=pilot)
    draws, _ = sample_posterior(left, SMALL, np.random.default_rng(2), compile_fit(prepared, SMALL))
    own, mu, sigma = (draws[name].values for name in ("log_k_v", "mu_log_k_v", "sigma_log_k_v"))
    z = (own[:, :, 2] - mu) / sigma
    assert abs(z.mean()) < 0.2
    assert abs(z.std() - 1) < 0.15
    z = (own[:, :, 3] - mu) / sigma
    assert z.std() < 0.9


def test_one_trial_of_a_campaign_keeps_its_likelihood(campaign):
    prepared = prepare_fit(campaign[0])
    noise = prepared.pilot.noise
    eta = prepared.pilot.modes.eta.reshape(7, 2, 4)
    whole = compute_log_likelihood_array(prepared.collapse, eta, *noise)
    alone, modes = keep_trial(prepared.collapse, prepared.pilot.modes, 4)
    one = compute_log_likelihood_array(alone, modes.eta.reshape(1, 2, 4), *noise)
    np.testing.assert_allclose(one, whole[4:5], rtol=1e-13)
