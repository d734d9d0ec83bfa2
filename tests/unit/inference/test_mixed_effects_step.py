"""Steps of a fit: how far they go, and what a fit may claim that has not arrived."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from softfinger.inference.mixed_effects import Prior
from softfinger.inference.mixed_effects_laplace import fit_nonlinear
from softfinger.inference.mixed_effects_linearised import SharedBounds
from softfinger.inference.mixed_effects_quadratic import expand, settle

FREE = SharedBounds(np.zeros(0), np.zeros(0), np.zeros(0))
VAGUE = Prior(np.zeros(2), np.full(2, 0.01), np.full(2, 5.0), 2.0, 2)


def gram_of(rows, missing):
    whole = np.column_stack([rows, missing])
    return whole.T @ whole


def bend(own, precise=1000.0, vague=10.0):
    """One trial: η₂ = sin 2η₁ is known a hundred times better than η₁ = 3 is."""
    one, two = own[0]
    rows = np.array([[-2.0 * precise * np.cos(2.0 * one), precise], [vague, 0.0]])
    return gram_of(rows, [precise * (np.sin(2.0 * one) - two), vague * (3.0 - one)])[None]


def fit_bend(steps, count=None):
    def linearise(own, shared):
        if count is not None:
            count.append(own.copy())
        return bend(own)

    start = np.zeros((1, 2)), np.zeros(0), 25.0 * np.eye(2)
    return fit_nonlinear(linearise, VAGUE, FREE, np.full(2, 1.0), start, steps=steps)


def test_one_trial_follows_its_own_bent_valley():
    """Steps as short as the valley is narrow take far more linearisations."""
    count = []
    fit = fit_bend(60, count)
    assert fit.converged
    np.testing.assert_allclose(fit.own[0], [3.0, np.sin(6.0)], atol=0.02)
    assert len(count) < 60


def test_a_fit_that_has_not_arrived_claims_what_its_place_has():
    """The linear model promises its best, which lies where the valley no longer is."""
    whole, cut = fit_bend(60), fit_bend(1)
    assert not cut.converged
    at = settle(VAGUE, cut.omega, cut.own, cut.shared)
    there = expand(VAGUE, cut.omega, at, cut.gram)
    assert there.value > 50.0
    assert cut.log_evidence < whole.log_evidence - 50.0


def test_a_step_keeps_to_bounds_and_others_follow():
    """φ wants to be 2 and may be 1; η, which is 3φ to a thousandth, then is 3."""

    def linearise(own, shared):
        rows = np.array([[1000.0, -3000.0], [0.0, 10.0]])
        missing = [1000.0 * (3.0 * shared[0] - own[0, 0]), 10.0 * (2.0 - shared[0])]
        return gram_of(rows, missing)[None]

    prior = Prior(np.zeros(2), np.full(2, 0.01), np.full(1, 5.0), 2.0, 1)
    bounds = SharedBounds(np.zeros(1), np.ones(1), np.ones(1))
    start = np.zeros((1, 1)), np.full(1, 0.5), 25.0 * np.eye(1)
    fit = fit_nonlinear(linearise, prior, bounds, np.full(1, 0.5), start, steps=20)
    assert fit.converged
    assert fit.shared[0] == pytest.approx(1.0)
    assert fit.own[0, 0] == pytest.approx(3.0, abs=1e-3)


@given(st.integers(0, 2**31))
def test_what_is_expected_is_what_a_linear_model_gains(seed):
    rng = np.random.default_rng(seed)
    rows, missing = rng.normal(size=(3, 9, 4)), rng.normal(size=(3, 9))
    prior = Prior(rng.normal(size=4), rng.uniform(0.1, 2.0, 4), np.ones(2), 2.0, 2)
    omega = np.diag(rng.uniform(0.1, 2.0, 2))

    def evaluate(own, shared):
        left = missing - np.einsum("tri,ti->tr", rows[..., :2], own) - rows[..., 2:] @ shared[2:]
        gram = np.stack([gram_of(r, m) for r, m in zip(rows, left, strict=True)])
        return expand(prior, omega, (own, shared), gram)

    place = rng.normal(size=(3, 2)), rng.normal(size=4)
    step = rng.normal(size=(3, 2)), rng.normal(size=4)
    before, after = evaluate(*place), evaluate(place[0] + step[0], place[1] + step[1])
    assert before.expect(step) == pytest.approx(before.value - after.value, rel=1e-9, abs=1e-9)
    alone, follows, shared, _ = before.solve(before.own[..., None], before.shared[:, None])
    answer = alone[..., 0] + follows @ shared[:, 0], shared[:, 0]
    rest = evaluate(place[0] + answer[0], place[1] + answer[1])
    np.testing.assert_allclose(rest.own, 0.0, atol=1e-8)
    np.testing.assert_allclose(rest.shared, 0.0, atol=1e-8)
