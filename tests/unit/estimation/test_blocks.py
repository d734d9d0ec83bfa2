"""Draws in blocks come from the posterior that NUTS draws from."""

import warnings
from contextlib import nullcontext

import numpy as np
import pytest
import xarray as xr
from scipy.stats import ks_2samp

from softfinger.artifacts.spec import list_tree_faults
from softfinger.artifacts.specs.posterior import SPEC
from softfinger.estimation import diagnose_sampling, fit_posterior
from softfinger.estimation.block_moves import mirror_populations
from softfinger.estimation.posterior import prepare_fit, sample_posterior
from softfinger.faults import Fault

NUTS = {
    "sampler": "nuts", "chains": 4, "tune": 200, "draws": 300, "cores": 2, "target_accept": 0.9,
    "max_depth": 10, "covariance": "independent",
}  # fmt: skip
BLOCKS = NUTS | {"sampler": "blocks", "tune": 100, "draws": 800}


def compare(angles, by_nuts, names):
    """Hold mean and sd of each quantity in blocks against draws by NUTS, in sds."""
    blocks, _ = sample_posterior(prepare_fit(angles), BLOCKS, np.random.default_rng(8))
    for name in names:
        x, y = (draws[name].stack(sample=("chain", "draw")) for draws in (by_nuts, blocks))
        away = (y.mean("sample") - x.mean("sample")) / x.std("sample")
        assert float(abs(away).max()) < 0.2, name
        ratio = y.std("sample") / x.std("sample")
        assert float(abs(np.log(ratio)).max()) < 0.3, name


POPULATION = ("mu_log_k_v", "mu_log_c_v", "mu_log_c_p", "mu_q_ini", "sigma_q_ini")
NOISE = ("noise_sd", "noise_autocorrelation")
OWN = ("log_k_v", "log_c_v", "log_c_p", "q_ini")


def test_both_samplers_draw_from_one_posterior(campaign, tree):
    compare(campaign[0], tree["posterior"].dataset, (*POPULATION, *NOISE, *OWN))


def test_a_chain_warns_of_nothing_that_it_would_have_to_silence(campaign, monkeypatch):
    """Chains run in threads, and what one thread silences another makes heard again."""
    fit = prepare_fit(campaign[0])
    monkeypatch.setattr(warnings, "catch_warnings", lambda **_: nullcontext())
    monkeypatch.setattr(warnings, "simplefilter", lambda *_, **__: None)
    sample_posterior(fit, BLOCKS | {"tune": 20, "draws": 2}, np.random.default_rng(8))


def test_what_mixes_badly_in_blocks_is_red(draw):
    early = draw(6, 1, 3)[0].isel(frame=slice(0, 9))  # the flow is 0.002 rad, the noise as large
    posterior, stats = sample_posterior(prepare_fit(early), BLOCKS, np.random.default_rng(8))
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


def test_a_whole_fit_in_blocks_is_judged_as_any(campaign):
    config = BLOCKS | {
        "draws": 500, "predictive_draws": 40, "r_hat_max": 1.02, "ess_min": 400.0,
        "divergences_max": 0, "outlier_rule": "scaled_mad", "outlier_cutoff": 3.0,
    }  # fmt: skip
    tree = fit_posterior(campaign[0], config, 3)
    assert list_tree_faults(SPEC, tree) == []
    assert diagnose_sampling(tree, config).attrs["verdict"] == "green"
    again = fit_posterior(campaign[0], config | {"cores": 1}, 3)
    np.testing.assert_array_equal(again["posterior"]["log_c_p"], tree["posterior"]["log_c_p"])


def test_parameters_that_go_together_are_refused(campaign):
    with pytest.raises(Fault, match="sampler blocks draws independent parameters only"):
        sample_posterior(
            prepare_fit(campaign[0]), BLOCKS | {"covariance": "full"}, np.random.default_rng(1)
        )


def test_mirrored_sweeps_alone_change_no_law():
    """Populations and trials drawn from the prior and mirrored once: they have the prior again."""
    rng = np.random.default_rng(1)
    prior = (np.zeros(1), np.ones(1), np.full(1, -1.0), np.full(1, 0.5))
    before, after = [], []
    for _ in range(4000):
        mu, sigma = rng.normal(size=1), np.exp(-1.0 + 0.5 * rng.normal(size=1))
        eta = mu[:, None] + sigma[:, None] * rng.normal(size=(1, 5))
        before.append([mu[0], np.log(sigma[0])])
        moved = mirror_populations(rng, eta, mu, sigma, prior)
        after.append([moved[0][0], np.log(moved[1][0])])
    for one, other in zip(np.transpose(before), np.transpose(after), strict=True):
        assert ks_2samp(one, other).pvalue > 0.01
    assert np.corrcoef(np.transpose(before)[1], np.transpose(after)[1])[0, 1] < 0.9
