"""What a model file does in place of the base: fitted, diagnosed again, sampled, moved."""

import arviz as az
import numpy as np
import pytest
import xarray as xr

from softfinger.inference.motion import build_mover
from softfinger.inference.posterior import fit_posterior, prepare_candidate, sample_posterior
from softfinger.inference.problem import pose_problem
from softfinger.inference.setting_table import tabulate_setting
from softfinger.mechanics.effects.model_file import EffectEntry, FittedTo, ModelFile, NormalPrior
from softfinger.mismatch import diagnose
from softfinger.mismatch.tables.outcome import describe_repair
from softfinger.mismatch.tables.predict import list_levels
from softfinger.mismatch.verdict import refine as refine_module
from softfinger.mismatch.verdict.refine import refine_verdict

CONFIG = {
    "bootstrap_replicates": 99,
    "false_alarm_probability": 0.01,
    "sample_repaired": False,
    "longest_search_s": 600.0,
}
FITTED_TO = FittedTo(campaign="drawn", sha256="0" * 64)


def quiet(items, _):
    return items


@pytest.fixture(scope="module")
def content(named):
    return describe_repair(named, FITTED_TO)


def test_a_repaired_model_is_adequate_when_it_is_diagnosed_again(recorded, content, named):
    again = diagnose(recorded, CONFIG, 5, quiet, content=content, priors=False)
    assert again.verdict.decision == "adequate"
    assert again.search.base.model.label == named.search.best.model.label
    before, after = named.verdict.residual_rms_rad, again.verdict.residual_rms_rad
    assert after.baseline == pytest.approx(before.final, rel=0.01)


@pytest.mark.parametrize("priors", [True, False])
def test_the_numbers_of_a_model_file_lead_to_its_mode(slow_lag, priors):
    """Also where they do not count: a lag and the joint may else change places."""
    known = NormalPrior(mean=0.3, sd=0.003)
    lag = EffectEntry(id="actuator_lag", form="first_order", priors={"lag_s": known})
    asked = ModelFile(version=1, joint="three_element", torque="constant_arm", effects=[lag])
    _, fit = pose_problem(slow_lag, asked, priors=priors)
    assert fit.shared[0] == pytest.approx(0.3, rel=0.05)


SAMPLING = {
    "sampler": "nuts", "chains": 2, "tune": 200, "draws": 200, "cores": 1, "target_accept": 0.8,
    "max_depth": 8, "covariance": "independent", "predictive_draws": 20,
}  # fmt: skip


@pytest.fixture(scope="module")
def sampled(recorded, named):
    prepared = prepare_candidate(recorded, named.problem, named.search.best)
    return sample_posterior(prepared, SAMPLING, np.random.default_rng(4))[0]


def test_sampling_agrees_with_the_fit(named, sampled):
    fit = named.search.best.fit
    draws = sampled["effect_internal"].transpose("chain", "draw", "effect_parameter").values
    sd = np.sqrt(np.diag(fit.shared_covariance))
    assert (np.abs((draws.mean((0, 1)) - fit.shared) / sd) < 0.5).all()
    np.testing.assert_allclose(draws.std((0, 1)) / sd, 1.0, atol=0.3)
    mean = sampled["mu_log_k_v"].mean().item()
    assert abs(mean - fit.mean[0]) < 0.5 * np.sqrt(fit.mean_covariance[0, 0])
    assert sampled["noise_scale"].mean() == pytest.approx(1.0, abs=0.05)
    assert float(az.rhat(sampled["effect"].to_dataset(name="x"))["x"].max()) < 1.05


def test_both_samplers_draw_the_effects_of_one_posterior(recorded, named, sampled):
    prepared = prepare_candidate(recorded, named.problem, named.search.best)
    config = SAMPLING | {"sampler": "gibbs", "tune": 200, "draws": 1500}
    drawn, _ = sample_posterior(prepared, config, np.random.default_rng(5))
    for name in ("effect_internal", "mu_log_c_p"):
        x, y = (draws[name].stack(sample=("chain", "draw")) for draws in (sampled, drawn))
        away = (y.mean("sample") - x.mean("sample")) / x.std("sample")
        assert float(abs(away).max()) < 0.35, name
        assert float(abs(np.log(y.std("sample") / x.std("sample"))).max()) < 0.35, name


@pytest.mark.parametrize("sampler", ["nuts", "gibbs"])
def test_a_fit_with_effects_has_every_group_of_the_base_s(recorded, content, sampler):
    config = SAMPLING | {"sampler": sampler, "tune": 100, "draws": 100}
    base = fit_posterior(recorded, config, 7)
    one = fit_posterior(recorded, config, 7, content)
    assert set(one.children) == set(base.children)
    for name, group in base.children.items():
        assert set(one[name].data_vars) == set(group.data_vars), name
    effect = one["posterior"]["effect"]
    assert sorted(effect["effect_parameter"].values.tolist()) == [
        "second_retardation.compliance_share_1",
        "second_retardation.retardation_time_s",
    ]
    time = effect.sel(effect_parameter="second_retardation.retardation_time_s")
    assert abs(float(time.mean()) - 1.5) < 0.5


def test_a_mover_gives_the_fitted_motion(recorded, content, named):
    fit, problem = named.search.best.fit, named.problem
    entries = named.search.best.model.entries
    physical = [np.exp(v) if e.parameter.log else v
                for v, e in zip(fit.shared, entries, strict=True)]  # fmt: skip
    effect = xr.DataArray([physical, physical], dims=("draw", "effect_parameter"))
    constant = tabulate_setting(problem.setting, problem.finger, problem.trials.name)
    move = build_mover(constant, content, effect, recorded["trial"])
    own = fit.own[[2, 4]].reshape(2, 1, 4)
    node = problem.trials.node[2].ravel()
    load = problem.trials.load_time[2], problem.trials.load_torque[2]
    angle = move(own, np.array([1, 0]), np.array([2, 2]), node, *load)
    expected, _ = problem.simulate(named.search.best.model, fit.own, fit.shared)
    np.testing.assert_allclose(angle[0], expected[2], atol=1e-5)
    assert np.abs(angle[1] - expected[2]).max() > 1e-3


def test_levels_are_told_apart(named):
    levels = list_levels(named.problem)
    assert list(levels) == pytest.approx([0.02, 0.03, 0.04])
    assert sum(chosen.sum() for chosen in levels.values()) == 7


def test_sampling_refines_the_parameters_of_a_verdict(named, recorded):
    refined, r_hat = refine_verdict(named, recorded, np.random.default_rng(3), 1.01)
    assert 0.9 < r_hat < 1.01
    before, after = named.verdict.effects[0], refined.effects[0]
    assert set(after.parameters) == set(before.parameters)
    for name, value in after.parameters.items():
        rough = before.parameters[name]
        assert value != rough
        assert abs(value.mean - rough.mean) < rough.sd
        assert value.q05 < value.mean < value.q95
    assert after.probability == before.probability
    assert refined.model_copy(update={"effects": []}) == named.verdict.model_copy(
        update={"effects": []}
    )


def test_chains_that_do_not_agree_refine_nothing(named, recorded, sampled, monkeypatch):
    monkeypatch.setattr(refine_module, "sample_posterior", lambda *_: (sampled, None))
    refined, _ = refine_verdict(named, recorded, np.random.default_rng(3), 0.1)
    assert refined == named.verdict


def test_nothing_is_sampled_where_nothing_was_left_out(clean, recorded):
    refined, r_hat = refine_verdict(clean, recorded, np.random.default_rng(3), 1.01)
    assert refined is clean.verdict
    assert np.isnan(r_hat)
