"""The artifacts of a diagnosis: what they declare, and what they say of a known campaign."""

from dataclasses import replace

import numpy as np
import pytest
import xarray as xr

from softfinger.artifacts.spec import list_faults
from softfinger.artifacts.specs import (
    free_form,
    laws,
    location,
    masking,
    measurement,
    ranking,
    repair,
)
from softfinger.mechanics.effects.model_file import FittedTo, build_model
from softfinger.mismatch.tables.outcome import (
    describe_repair,
    tabulate_diagnosis,
    tabulate_free_form,
)

SPECS = {
    spec.SPEC.name: spec.SPEC
    for spec in (ranking, location, masking, repair, free_form, laws, measurement)
}
CONFIG = {
    "bootstrap_replicates": 99,
    "false_alarm_probability": 0.01,
    "sample_repaired": False,
    "longest_search_s": 600.0,
}


@pytest.fixture(scope="module")
def tables(named, recorded):
    return tabulate_diagnosis(named, recorded.assign_attrs(source="synthetic"), CONFIG, 3)


def test_every_table_is_the_declared_artifact(tables):
    assert {name: list_faults(SPECS[name], table) for name, table in tables.items()} == {
        name: [] for name in SPECS
    }
    assert tables["repair"].attrs["effects"] == "second_retardation"


def test_the_ranking_puts_what_was_left_out_first(tables):
    found = tables["ranking"]
    assert str(found["effect"].values[0]) == "second_retardation"
    assert found["set_probability"].sum() == pytest.approx(1.0)
    assert float(found["gain"].sel(model="base")) == 0.0
    assert (np.diff(found["gain"]) <= 0).all()
    assert float(found["best_gain"][0]) > float(found["needed_gain"])
    assert found.sizes["replicate"] == 99


def test_the_base_misses_where_the_repair_does_not(tables):
    within = tables["location"]["q_value"]
    assert float(within.sel(model="base").min()) < 1e-6
    assert float(within.sel(model="final").min()) > 1e-3


def test_the_repair_agrees_with_the_verdict(tables, named):
    found, verdict = tables["repair"], named.verdict
    difference = found["elpd"].sel(model="final") - found["elpd"].sel(model="base")
    assert float(difference.sum()) == pytest.approx(verdict.elpd.difference)
    rms = np.sqrt((found["residual_rms"] ** 2).mean(("trial", "joint")))
    assert float(rms.sel(model="final")) == pytest.approx(verdict.residual_rms_rad.final, rel=0.02)
    mean = found["population_mean"]
    np.testing.assert_allclose(found["bias"], mean.sel(model="base") - mean.sel(model="final"))
    share = found["explained_spread"].sel(joint=1, parameter="log_k_v")
    assert float(share) == pytest.approx(verdict.explained_spread["log_k_v"]["1"])


def test_left_out_trials_and_levels_are_predicted(tables):
    found = tables["repair"]
    np.testing.assert_allclose(found["level"], [0.02, 0.03, 0.04])
    assert found["level_n_trials"].values.tolist() == [3, 2, 2]
    reach = float(found["recorded_angle"].max())
    assert (found["level_error"].sel(model="final") < 0.5 * reach).all()
    inside = found["coverage"].sel(model="final", ci_prob=0.9)
    assert (inside > 0.6).all()
    assert (found["coverage_bound"].sel(bound="lower") <= found["coverage"]).all()
    low, high = (found["predicted_quantile"].isel(quantile=end) for end in (0, -1))
    recorded, noise = found["recorded_angle"], 2 * found["bin_noise_sd"]
    within = (low - noise < recorded) & (recorded < high + noise)
    seen = recorded.notnull()
    share = within.sum(("trial", "bin")) / seen.sum(("trial", "bin"))
    assert (share >= found["coverage"].sel(ci_prob=0.9) - 0.02).all()
    assert (np.isfinite(low) == seen).all()


def test_the_noise_of_a_bin_is_that_of_the_mean_of_its_frames(tables, named):
    sd = tables["repair"]["bin_noise_sd"].values[0, 0]
    counts = np.diff(named.problem.trials.starts[0])
    frame = float(tables["repair"]["noise_sd"][0])
    assert sd[counts == 1] == pytest.approx(frame, rel=1e-6)
    assert (sd[: len(counts)][counts > 1] < frame).all()


def test_the_repaired_model_returns_as_fitted(named):
    content = describe_repair(named, FittedTo(campaign="drawn", sha256="0" * 64))
    model = build_model(content, named.problem.setting)
    best = named.search.best
    assert model.label == best.model.label
    np.testing.assert_allclose(model.shared_prior[0], best.fit.shared, rtol=1e-5)


def test_the_repaired_model_has_the_spread_that_was_found(named):
    spread = {"second_retardation:compliance_share": 0.2, "drift": 1.0}
    found = named._replace(problem=replace(named.problem, disturbed=spread))
    content = describe_repair(found, FittedTo(campaign="drawn", sha256="0" * 64))
    assert content.effects[0].spreads == {"compliance_share": 0.2}


def test_without_left_out_physics_nothing_is_repaired(clean, draw_campaign):
    recorded = draw_campaign(2, 0.0).assign_attrs(source="synthetic")
    found = tabulate_diagnosis(clean, recorded, CONFIG, 3)
    assert {name: list_faults(SPECS[name], table) for name, table in found.items()} == {
        name: [] for name in SPECS
    }
    assert found["free_form"].sizes["quantity"] == 0
    np.testing.assert_array_equal(found["repair"]["bias"], 0.0)
    one, other = (found["repair"].sel(model=name, drop=True) for name in ("base", "final"))
    xr.testing.assert_identical(one, other)  # one model, one set of draws
    assert describe_repair(clean, FittedTo(campaign="a", sha256="0" * 64)).effects == []


def test_a_free_form_term_improves_the_prediction_of_left_out_trials(thinned):
    found = tabulate_free_form(thinned)
    assert list_faults(free_form.SPEC, found.assign_attrs(campaign="drawn", source="")) == []
    assert float(found["elpd_difference"]) == pytest.approx(found.attrs["gain_nats"], rel=0.5)
    assert float(found["elpd_difference"]) > float(found["elpd_se"]) > 0
    assert float(found["excess"]) < 0.05 < float(found["excess_without"])
