"""Weights that turn draws of an expansion into draws of the model."""

from dataclasses import replace

import numpy as np
import pytest

from softfinger.inference import correction
from softfinger.inference.correction import correct_draws
from softfinger.inference.posterior import prepare_fit


@pytest.fixture(scope="module")
def prepared(draw):
    return prepare_fit(draw(3, 1, 5)[0])


def draw_about(prepared, wide, count=200):
    """Draws of the trials' parameters, `wide` times as dispersed as the fit has them."""
    rng = np.random.default_rng(4)
    fit = prepared.recorded.candidate.fit
    roots = np.linalg.cholesky(fit.own_covariance)
    normal = rng.standard_normal((2, count, *fit.own.shape))
    eta = fit.own + wide * np.einsum("tab,cdtb->cdta", roots, normal)
    return {"eta": eta, "effect": np.zeros((2, count, 0)), "noise_scale": np.ones((2, count))}


def correct(prepared, expansion, drawn):
    recorded = prepared.recorded
    rng = np.random.default_rng(1)
    return correct_draws(recorded.problem, recorded.candidate, expansion, drawn, rng)


def test_a_good_expansion_keeps_nearly_every_draw(prepared):
    found = correct(prepared, prepared.given.expansion, draw_about(prepared, 1.0))
    assert found.pareto_k < 0.7
    assert found.error < 0.3
    assert len(np.unique(found.kept[0])) > 150


def test_a_wrong_expansion_is_mended_by_the_weights(prepared):
    """Draws of a likelihood that is too wide: weighing gives back the model's own spread."""
    expansion = prepared.given.expansion
    drawn = draw_about(prepared, 0.8**-0.5, 4000)
    flat = expansion._replace(gram=0.8 * expansion.gram)
    found = correct(prepared, flat, drawn)
    assert found.pareto_k < 0.7
    before = drawn["eta"][0, :, :, 0].std(axis=0)
    after = drawn["eta"][0, found.kept[0], :, 0].std(axis=0)
    assert (after < before).all()


@pytest.mark.parametrize("wide", [3.0, 40.0])
def test_a_hopeless_expansion_is_told(prepared, wide):
    """Draws three times too wide have weights with k = 0.95."""
    found = correct(prepared, prepared.given.expansion, draw_about(prepared, wide))
    assert not found.pareto_k < 0.7
    np.testing.assert_array_equal(found.kept[0], np.arange(200))


def test_few_draws_are_not_weighed(prepared):
    for count, weighed in ((12, False), (20, True)):
        found = correct(prepared, prepared.given.expansion, draw_about(prepared, 1.0, count))
        assert np.isfinite(found.pareto_k) == weighed


def test_draws_of_many_trials_are_kept_as_they_are(prepared, monkeypatch):
    """Half of 1600 draws would be left, and a thousand are asked for."""
    trials = len(prepared.recorded.candidate.fit.own)
    drawn = draw_about(prepared, 1.0, 800)
    small = replace(correction.BUDGET, simulated=800 * trials, measured=100 * trials)
    monkeypatch.setattr(correction, "BUDGET", small)
    found = correct(prepared, prepared.given.expansion, drawn)
    assert np.isnan(found.pareto_k)
    np.testing.assert_array_equal(found.kept[0], np.arange(800))


def test_a_chain_that_the_model_rules_out_is_told(prepared, monkeypatch):
    """One chain far away: its draws weigh nothing, and none of them may be drawn anew."""

    def measure(problem, candidate, expansion, draws, chain, every):
        near = 0.1 * np.random.default_rng(chain).standard_normal((200, 5))
        return near - 1000.0 * chain

    monkeypatch.setattr(correction, "_measure_change", measure)
    found = correct(prepared, prepared.given.expansion, draw_about(prepared, 1.0))
    assert found.pareto_k > 0.7
    np.testing.assert_array_equal(found.kept[1], np.arange(200))
