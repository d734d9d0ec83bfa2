"""What a model file does in place of the base: fitted, diagnosed again, sampled, moved."""

import arviz as az
import numpy as np
import pytest
import xarray as xr

from softfinger.mechanics.effects.model_file import FittedTo
from softfinger.mismatch import diagnose
from softfinger.mismatch.fit import fit_effects
from softfinger.mismatch.forward import build_mover
from softfinger.mismatch.mcmc import Size, sample_effects
from softfinger.mismatch.outcome import describe_repair
from softfinger.mismatch.predict import list_levels
from softfinger.mismatch.refine import refine_verdict

CONFIG = {
    "bootstrap_replicates": 99,
    "false_alarm_probability": 0.01,
    "sample_repaired": False,
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


def test_sampling_agrees_with_the_fit(named, monkeypatch):
    monkeypatch.setattr("softfinger.mismatch.mcmc.DISPERSION", 0.3)  # few draws: start close
    best = named.search.best
    rng = np.random.default_rng(4)
    draws, accepted = sample_effects(named.problem, best, Size(2, 30, 60), rng, quiet)
    for name, middle, covariance in (
        ("effect", best.fit.shared, best.fit.shared_covariance),
        ("mean", best.fit.mean, best.fit.mean_covariance),
    ):
        sd = np.sqrt(np.diag(covariance))
        away = (draws[name].mean((0, 1)) - middle) / sd
        assert (np.abs(away) < 2.0).all()
        assert ((draws[name].std((0, 1)) / sd > 0.4) & (draws[name].std((0, 1)) / sd < 2.0)).all()
    assert 0.3 < accepted.mean() < 1.0
    assert draws["scale"].mean() == pytest.approx(1.0, abs=0.05)
    effect = xr.DataArray(draws["effect"], dims=("chain", "draw", "k"))
    assert float(az.rhat(effect.to_dataset(name="x"))["x"].max()) < 1.3


def test_the_fit_names_its_draws_and_keeps_them_for_a_seed(recorded, content):
    config = {"chains": 2, "tune": 6, "draws": 5}
    one, two = (fit_effects(recorded, content, config, 7, priors=True) for _ in range(2))
    xr.testing.assert_identical(one["posterior"].dataset, two["posterior"].dataset)
    effect = one["posterior"]["effect"]
    names = effect["effect_parameter"].values.tolist()
    assert sorted(names) == [
        "second_retardation.compliance_share_1",
        "second_retardation.retardation_time_s",
    ]
    assert effect.sizes["draw"] == 5
    time = effect.sel(effect_parameter="second_retardation.retardation_time_s")
    assert abs(float(time.mean()) - 1.5) < 0.5


def test_a_mover_gives_the_fitted_motion(recorded, content, named):
    fit, problem = named.search.best.fit, named.problem
    entries = named.search.best.model.entries
    physical = [np.exp(v) if e.parameter.log else v
                for v, e in zip(fit.shared, entries, strict=True)]  # fmt: skip
    effect = xr.DataArray([physical, physical], dims=("draw", "effect_parameter"))
    move = build_mover(recorded, content, effect)
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


def test_sampling_refines_the_parameters_of_a_verdict(named, monkeypatch):
    monkeypatch.setattr("softfinger.mismatch.refine.R_HAT_MAX", 1.5)
    size = Size(2, 20, 40)
    refined, r_hat = refine_verdict(named, np.random.default_rng(3), size, quiet)
    assert 0.9 < r_hat < 1.5
    before, after = named.verdict.effects[0], refined.effects[0]
    assert set(after.parameters) == set(before.parameters)
    for name, value in after.parameters.items():
        rough = before.parameters[name]
        assert value != rough
        assert abs(value.mean - rough.mean) < 2 * rough.sd
        assert value.q05 < value.mean < value.q95
    assert after.probability == before.probability
    assert refined.model_copy(update={"effects": []}) == named.verdict.model_copy(
        update={"effects": []}
    )


def test_chains_that_do_not_agree_refine_nothing(named, monkeypatch):
    monkeypatch.setattr("softfinger.mismatch.refine.R_HAT_MAX", 0.1)
    refined, _ = refine_verdict(named, np.random.default_rng(3), Size(2, 6, 8), quiet)
    assert refined == named.verdict


def test_nothing_is_sampled_where_nothing_was_left_out(clean):
    refined, r_hat = refine_verdict(clean, np.random.default_rng(3))
    assert refined is clean.verdict
    assert np.isnan(r_hat)
