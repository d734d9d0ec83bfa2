"""Independence of parameters and sensitivity to priors."""

import numpy as np
import xarray as xr

from softfinger.inference.assumptions import judge_independence, measure_prior_sensitivity
from softfinger.inference.density import Effects
from softfinger.inference.priors import PopulationPrior

NAMES = ("log_k_v", "log_c_v", "log_c_p", "q_ini")


def build_posterior(eta, trials=60):
    """Trials known exactly, of a standard normal population: one joint, two equal draws."""
    dims, own = ("chain", "draw", "joint"), ("chain", "draw", "trial", "joint")
    known = {name: (own, np.tile(eta[:, k, None], (1, 2, 1, 1))) for k, name in enumerate(NAMES)}
    known |= {f"mu_{name}": (dims, np.zeros((1, 2, 1))) for name in NAMES}
    known |= {f"sigma_{name}": (dims, np.ones((1, 2, 1))) for name in NAMES}
    return xr.Dataset(known, {"joint": [1]})


def test_independent_parameters_pass():
    smallest = [
        float(judge_independence(build_posterior(rng.standard_normal((60, 4))))["smallest_p"])
        for rng in map(np.random.default_rng, range(20))
    ]
    assert np.mean(np.array(smallest) < 0.05) <= 0.15


def test_parameters_that_go_together_are_found():
    eta = np.random.default_rng(1).standard_normal((60, 4))
    eta[:, 2] = 0.6 * eta[:, 0] + 0.8 * eta[:, 2]
    found = judge_independence(build_posterior(eta))
    pair = {"own": "log_c_p[1]", "other_own": "log_k_v[1]"}
    assert found["p_value"].sel(pair) < 0.01
    assert 0.3 < found["mean_product"].sel(pair) < 0.9
    assert found["smallest_p"] < 0.05


def test_spreads_of_few_trials_hang_on_the_prior_more_than_means(tree):
    found = tree["prior_sensitivity"].dataset
    assert np.isfinite(found[["prior", "likelihood"]].to_array()).all()
    mean, spread = (found["prior"].sel(level=level).mean() for level in ("mu", "sigma"))
    assert spread > mean
    assert (found["likelihood"] > found["prior"]).mean() > 0.9


def test_an_effect_that_the_recordings_do_not_show_depends_on_its_prior():
    rng = np.random.default_rng(2)
    eta = rng.standard_normal((5, 4))
    draws, dims = rng.standard_normal((4, 500, 2)), ("chain", "draw")
    draws[..., 1] *= 0.1
    posterior = build_posterior(eta).isel(chain=[0] * 4, draw=[0] * 500)
    posterior = posterior + 0.1 * xr.DataArray(rng.standard_normal((4, 500)), dims=dims)
    posterior = posterior.assign(
        {f"sigma_{name}": np.exp(posterior[f"sigma_{name}"]) for name in NAMES}
        | {"effect_internal": ((*dims, "effect_parameter"), draws)}
    )
    posterior = posterior.assign_coords(
        chain=range(4), draw=range(500), effect_parameter=["unseen", "seen"]
    )
    seen = xr.DataArray(-0.5 * (draws[..., 1:] / 0.1) ** 2, dims=(*dims, "trial"))
    prior = PopulationPrior(np.zeros(4), np.ones(4), np.ones(4), np.ones(4), 0.05)
    effects = Effects(["unseen", "seen"], np.zeros(2), np.ones(2), None)
    found = measure_prior_sensitivity(posterior, seen, prior, effects)
    unseen, shown = (found.sel(effect_parameter=name) for name in ("unseen", "seen"))
    assert unseen["effect_prior"] > 0.05 > unseen["effect_likelihood"]
    assert shown["effect_likelihood"] > 0.05 > shown["effect_prior"]
