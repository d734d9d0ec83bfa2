"""The reduced evidence against the same integral done densely."""

import numpy as np
import pytest

from softfinger.concealed.mixed_effects import (
    MEAN_CENTRE,
    MEAN_SD,
    SPREAD_CENTRE,
    Linearised,
    _integrate,
    solve_mixed_model,
)

TRIALS, ROWS, OWN, EFFECTS = 5, 30, 12, 2
CENTRE, SD = np.array([0.3, -0.2]), np.array([0.7, 1.5])


@pytest.fixture
def problem():
    rng = np.random.default_rng(8)
    own = 3.0 * rng.normal(size=(TRIALS, ROWS, OWN))
    effect = rng.normal(size=(TRIALS, ROWS, EFFECTS))
    eta = MEAN_CENTRE + rng.normal(size=(TRIALS, OWN)) * 0.4
    z = np.einsum("tri,ti->tr", own, eta) + effect @ CENTRE + rng.normal(size=(TRIALS, ROWS))
    return own, effect, z, rng


def _reduce(problem):
    own, effect, z, rng = problem
    point = np.column_stack(
        [MEAN_CENTRE + 0.1 * rng.normal(size=(TRIALS, OWN)), np.tile([0.1, 0.2], (TRIALS, 1))]
    )
    design = np.concatenate([own, effect], axis=2)
    residual = z - np.einsum("trx,tx->tr", design, point)
    return Linearised(
        np.einsum("trx,try->txy", design, design),
        np.einsum("trx,tr->tx", design, residual),
        (residual**2).sum(axis=1),
        point,
    )


def _dense_log_evidence(problem, log_spread, trials):
    """−½ (quadratic form + log determinant) of the stacked trials' normal density."""
    own, effect, z, _ = problem
    a, b = np.concatenate(own[trials]), np.concatenate(effect[trials])
    covariance = np.eye(len(a)) + a * MEAN_SD**2 @ a.T + b * SD**2 @ b.T
    for k in range(len(trials)):
        at = slice(k * ROWS, (k + 1) * ROWS)
        covariance[at, at] += own[trials[k]] * np.exp(2 * log_spread) @ own[trials[k]].T
    off = np.concatenate(z[trials]) - a @ MEAN_CENTRE - b @ CENTRE
    return -0.5 * (off @ np.linalg.solve(covariance, off) + np.linalg.slogdet(covariance)[1])


def test_evidence_is_the_dense_integral(problem):
    trials, log_spread = _reduce(problem), SPREAD_CENTRE + 0.3
    found = _integrate(trials, CENTRE, SD, log_spread)
    everyone = list(range(TRIALS))
    assert found.value == pytest.approx(_dense_log_evidence(problem, log_spread, everyone))
    for k in everyone:
        rest = [other for other in everyone if other != k]
        expected = found.value - _dense_log_evidence(problem, log_spread, rest)
        assert found.contributions[k] == pytest.approx(expected)


def test_slope_is_the_derivative_of_the_evidence(problem):
    trials, log_spread, h = _reduce(problem), SPREAD_CENTRE - 0.2, 1e-5
    slope = _integrate(trials, CENTRE, SD, log_spread).slope
    for k, unit in enumerate(np.eye(OWN)):
        ends = [_integrate(trials, CENTRE, SD, log_spread + s * h * unit).value for s in (1, -1)]
        assert slope[k] == pytest.approx((ends[0] - ends[1]) / (2 * h), rel=1e-4, abs=1e-5)


def test_a_trial_may_stand_for_several(problem):
    trials = _reduce(problem)
    doubled = Linearised(*(np.concatenate([x, x]) for x in list(vars(trials).values())[:4]))
    counted = Linearised(*list(vars(trials).values())[:4], times=2.0)
    first, second = (solve_mixed_model(t, CENTRE, SD) for t in (doubled, counted))
    assert first.log_evidence == pytest.approx(second.log_evidence, abs=1e-3)
    np.testing.assert_allclose(first.effect, second.effect, atol=1e-4)


def test_the_effects_are_found_within_their_sd(problem):
    solution = solve_mixed_model(_reduce(problem), CENTRE, SD)
    assert np.all(np.abs(solution.effect - CENTRE) < 4.0 * solution.effect_sd)
    assert np.all(solution.effect_sd < 0.3 * SD)
