"""Gibbs draws come from the posterior that NUTS draws from."""

import warnings
from contextlib import nullcontext

import numpy as np
import pytest
import xarray as xr

from softfinger.artifacts.spec import list_tree_faults
from softfinger.artifacts.specs.posterior import SPEC
from softfinger.estimation import diagnose_sampling
from softfinger.faults import Fault
from softfinger.inference.posterior import fit_posterior, prepare_fit, sample_posterior

NUTS = {
    "sampler": "nuts", "chains": 4, "tune": 200, "draws": 300, "cores": 2, "target_accept": 0.9,
    "max_depth": 10, "covariance": "independent",
}  # fmt: skip
GIBBS = NUTS | {"sampler": "gibbs", "tune": 100, "draws": 800}


def compare(angles, by_nuts, names):
    """Hold mean and sd of each quantity by Gibbs sampling against draws by NUTS, in sds."""
    drawn, _ = sample_posterior(prepare_fit(angles), GIBBS, np.random.default_rng(8))
    for name in names:
        x, y = (draws[name].stack(sample=("chain", "draw")) for draws in (by_nuts, drawn))
        away = (y.mean("sample") - x.mean("sample")) / x.std("sample")
        assert float(abs(away).max()) < 0.2, name
        ratio = y.std("sample") / x.std("sample")
        assert float(abs(np.log(ratio)).max()) < 0.3, name


POPULATION = ("mu_log_k_v", "mu_log_c_v", "mu_log_c_p", "mu_q_ini", "sigma_q_ini")
NOISE = ("noise_sd",)
OWN = ("log_k_v", "log_c_v", "log_c_p", "q_ini")


def test_both_samplers_draw_from_one_posterior(known_campaign, tree):
    compare(known_campaign[0], tree["posterior"].dataset, (*POPULATION, *NOISE, *OWN))


def test_a_chain_warns_of_nothing_that_it_would_have_to_silence(known_campaign, monkeypatch):
    """Chains run in threads, and what one thread silences another makes heard again."""
    fit = prepare_fit(known_campaign[0])
    monkeypatch.setattr(warnings, "catch_warnings", lambda **_: nullcontext())
    monkeypatch.setattr(warnings, "simplefilter", lambda *_, **__: None)
    sample_posterior(fit, GIBBS | {"tune": 20, "draws": 2}, np.random.default_rng(8))


def test_what_mixes_badly_by_gibbs_is_red(draw):
    early = draw(6, 1, 3)[0].isel(frame=slice(0, 9))  # the flow is 0.002 rad, the noise as large
    posterior, stats = sample_posterior(prepare_fit(early), GIBBS, np.random.default_rng(8))
    tree = xr.DataTree.from_dict({"posterior": posterior, "sample_stats": stats})
    limits = {"r_hat_max": 1.01, "ess_min": 400.0, "divergences_max": 0}
    assert diagnose_sampling(tree, limits).attrs["verdict"] == "red"


def test_a_joint_that_is_missing_from_a_trial_is_drawn_from_its_population(draw):
    angles, _ = draw(6, 2, 4)
    holed = angles["joint_angle"].copy()
    holed[2, 1] = np.nan
    angles = angles.assign(joint_angle=holed)
    by_nuts, _ = sample_posterior(prepare_fit(angles), NUTS, np.random.default_rng(7))
    compare(angles, by_nuts, ("mu_log_k_v", "log_k_v", "noise_sd"))


def test_a_whole_fit_by_gibbs_is_judged_as_any(known_campaign):
    config = GIBBS | {
        "draws": 500, "predictive_draws": 40, "r_hat_max": 1.02, "ess_min": 400.0,
        "divergences_max": 0, "outlier_rule": "scaled_mad", "outlier_cutoff": 3.0,
    }  # fmt: skip
    tree = fit_posterior(known_campaign[0], config, 3)
    assert list_tree_faults(SPEC, tree) == []
    assert diagnose_sampling(tree, config).attrs["verdict"] == "green"


def test_chains_are_the_same_on_one_core_and_two(known_campaign):
    prepared = prepare_fit(known_campaign[0])
    one, two = (
        sample_posterior(
            prepared, GIBBS | {"tune": 20, "draws": 20, "cores": n}, np.random.default_rng(1)
        )[0]
        for n in (1, 2)
    )
    assert one.identical(two)


def test_parameters_that_go_together_are_refused(known_campaign):
    with pytest.raises(Fault, match="sampler gibbs draws independent parameters only"):
        sample_posterior(
            prepare_fit(known_campaign[0]), GIBBS | {"covariance": "full"}, np.random.default_rng(1)
        )
