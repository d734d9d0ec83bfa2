"""The hierarchical posterior: its groups, its truth, its repeatability, trials left out."""

import numpy as np

from softfinger.artifacts.spec import list_tree_faults
from softfinger.artifacts.specs.posterior import SPEC
from softfinger.estimation import diagnose_sampling
from softfinger.inference.expansion import forget_trial
from softfinger.inference.posterior import (
    compile_fit,
    draw_points,
    prepare_fit,
    sample_posterior,
)
from softfinger.inference.whitening import read_trials

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
    far = tree.copy()
    far["sample_stats"] = far["sample_stats"].dataset.assign(expansion_pareto_k=((), 0.9))
    assert diagnose_sampling(far, config).attrs["verdict"] == "red"


def test_the_expansion_is_near_the_model(tree):
    stats = tree["sample_stats"].dataset
    assert float(stats["expansion_pareto_k"]) < 0.7
    assert float(stats["expansion_error"]) < 0.3


def test_trials_are_found_within_their_uncertainty(tree, known_campaign):
    true = stack_trials(known_campaign[1])
    draws = np.stack([tree["posterior"][name].values for name in NAMES], axis=-1)
    draws = draws.reshape(-1, *true.shape)
    z = (draws.mean(axis=0) - true) / draws.std(axis=0)
    assert 0.6 < np.sqrt((z**2).mean()) < 1.4  # 56 of them: rms 1 ± 0.1


def test_the_noise_is_found(tree):
    posterior = tree["posterior"].dataset
    for name, true, tolerance in (("noise_sd", 0.002, 2e-4), ("noise_autocorrelation", 0.3, 0.1)):
        np.testing.assert_allclose(posterior[name].mean(("chain", "draw")), true, atol=tolerance)


def test_the_same_draws_on_one_core_and_two(known_campaign):
    prepared = prepare_fit(known_campaign[0])
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


def test_a_forgotten_trial_has_the_population_s_parameters(known_campaign):
    prepared = prepare_fit(known_campaign[0])
    less = forget_trial(prepared.given.expansion, 2)
    value, variance = read_trials(less.curvature, less.pull, prepared.given.prior)
    given = prepared.given._replace(expansion=less, value=value, variance=variance)
    density = compile_fit(prepared, SMALL)
    draws, _ = draw_points(prepared, SMALL, np.random.default_rng(2), density, given)
    z = (draws["eta"][..., 0] - draws["mu"][..., None, 0]) / draws["sigma"][..., None, 0]
    assert abs(z[..., 2].mean()) < 0.2
    assert abs(z[..., 2].std() - 1) < 0.15
    assert z[..., 3].std() < 0.9
