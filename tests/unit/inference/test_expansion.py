"""The expanded likelihood: its slopes, its reach, and one trial less."""

import numpy as np
import pytest

from softfinger.inference.expansion import (
    fill_squares,
    forget_trial,
    keep_trial,
    slope_squares,
)
from softfinger.inference.motion import measure_draws
from softfinger.inference.posterior import prepare_fit


@pytest.fixture(scope="module")
def prepared(draw):
    return prepare_fit(draw(4, 2, 5)[0])


@pytest.fixture
def away(prepared, rng):
    own = prepared.given.expansion.own
    return np.ascontiguousarray((own + 0.1 * rng.standard_normal(own.shape)).T)


def measure(expansion, eta):
    square = np.empty(len(expansion.own))
    fill_squares(eta, expansion.shared, expansion.own, expansion.shared, expansion.gram, square)
    return square


def test_slopes_are_those_of_differences(prepared, away, rng):
    expansion = prepared.given.expansion
    place = (expansion.own, expansion.shared, expansion.gram)
    total, by_eta, _ = slope_squares(away, expansion.shared, *place)
    assert total == pytest.approx(measure(expansion, away).sum())
    turn, step = rng.standard_normal(away.shape), 1e-6
    ends = [measure(expansion, away + sign * step * turn).sum() for sign in (1, -1)]
    assert (by_eta * turn).sum() == pytest.approx((ends[0] - ends[1]) / (2 * step), rel=1e-5)


def test_slopes_by_effects_are_those_of_differences(rng):
    root = rng.standard_normal((3, 9, 7))
    gram, own, shared = root.transpose(0, 2, 1) @ root, rng.standard_normal((3, 4)), np.zeros(2)
    eta, effect = np.ascontiguousarray(own.T) + 0.1, np.array([0.3, -0.2])
    _, _, slope = slope_squares(eta, effect, own, shared, gram)
    square, step = np.empty((2, 3)), 1e-6
    for k in range(2):
        for end, sign in enumerate((1, -1)):
            moved = effect + sign * step * np.eye(2)[k]
            fill_squares(eta, moved, own, shared, gram, square[end])
        difference = (square[0] - square[1]).sum() / (2 * step)
        assert slope[k] == pytest.approx(difference, rel=1e-5)


def test_flow_is_exact_however_far_log_c_p_goes(prepared):
    """The motion is linear in 1/c_p, so the expansion holds where a normal in log c_p does not."""
    expansion = prepared.given.expansion
    eta = np.ascontiguousarray(expansion.own.T)
    eta[2] += 3.0
    candidate, problem = prepared.recorded.candidate, prepared.recorded.problem
    exact = measure_draws(problem, candidate, eta.T[None], np.zeros((1, 0)))[0]
    np.testing.assert_allclose(measure(expansion, eta), exact, rtol=1e-4)


def test_draws_of_a_trial_s_posterior_are_nearly_exact(prepared, rng):
    expansion, fit = prepared.given.expansion, prepared.recorded.candidate.fit
    roots = np.linalg.cholesky(fit.own_covariance)
    eta = fit.own + np.einsum("tab,dtb->dta", roots, rng.standard_normal((40, *fit.own.shape)))
    candidate, problem = prepared.recorded.candidate, prepared.recorded.problem
    exact = measure_draws(problem, candidate, eta, np.zeros((40, 0)))
    near = np.stack([measure(expansion, np.ascontiguousarray(one.T)) for one in eta])
    assert np.std(0.5 * (exact - near)) < 0.3


def test_a_forgotten_trial_leaves_the_others(prepared, away):
    whole = measure(prepared.given.expansion, away)
    less = measure(forget_trial(prepared.given.expansion, 2), away)
    assert less[2] == 0.0
    np.testing.assert_array_equal(np.delete(less, 2), np.delete(whole, 2))


def test_one_trial_keeps_its_likelihood(prepared, away):
    alone = keep_trial(prepared.given.expansion, 3)
    np.testing.assert_allclose(
        measure(alone, np.ascontiguousarray(away[:, 3:4])),
        measure(prepared.given.expansion, away)[3],
    )
