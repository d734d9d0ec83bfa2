import numpy as np
import pytest
from scipy.stats import multivariate_normal

from softfinger.inference import mixed_effects_laplace
from softfinger.inference.budget import BUDGET
from softfinger.inference.mixed_effects import (
    LOG_TWO_PI,
    Prior,
    fit_linear,
    hold_omega,
    solve_gram,
)
from softfinger.inference.mixed_effects_laplace import fit_nonlinear
from softfinger.inference.mixed_effects_linearised import SharedBounds
from softfinger.inference.mixed_effects_step import Taken

TRIALS, OWN, SHARED = 7, 4, 2


def draw(rng, trials=TRIALS, rows=11, block=2):
    """Whitened trials of a linear model with known answers: gram, (design, value) and truth."""
    omega = np.zeros((OWN, OWN))
    for first in range(0, OWN, block):
        factor = rng.normal(size=(block, block)) * 0.4 + 0.3 * np.eye(block)
        omega[first : first + block, first : first + block] = factor @ factor.T
    mu, phi = rng.normal(size=OWN), rng.normal(size=SHARED)
    parts = []
    for _ in range(trials):
        design = rng.normal(size=(rows, OWN + SHARED))
        own = rng.multivariate_normal(mu, omega)
        parts.append((design, design @ np.append(own, phi) + rng.normal(size=rows)))
    gram = np.stack([(c := np.column_stack(part)).T @ c for part in parts])
    return gram, parts, (mu, phi, omega)


@pytest.fixture
def prior():
    mean = np.linspace(-0.5, 0.5, OWN + SHARED)
    return Prior(mean, np.linspace(0.2, 0.6, OWN + SHARED), np.full(OWN, 0.3), 2.0, 2)


def test_evidence_is_that_of_the_joint_normal_distribution(prior):
    gram, parts, (_, _, omega) = draw(np.random.default_rng(1))
    fit = hold_omega(gram, prior, omega)
    design = np.concatenate([part[0] for part in parts])
    value = np.concatenate([part[1] for part in parts])
    covariance = np.eye(len(value)) + design @ np.diag(1 / prior.precision) @ design.T
    begin = 0
    for part, _ in parts:
        rows = slice(begin, begin + len(part))
        covariance[rows, rows] += part[:, :OWN] @ omega @ part[:, :OWN].T
        begin += len(part)
    expected = multivariate_normal.logpdf(value, design @ prior.mean, covariance)
    spread = prior.weight * np.sum(np.diag(np.linalg.inv(omega)) * prior.spread**2)
    expected += -0.5 * prior.weight * np.linalg.slogdet(omega)[1] - 0.5 * spread
    assert fit.log_evidence - 0.5 * LOG_TWO_PI * len(value) == pytest.approx(expected, abs=1e-8)


def test_the_spread_between_trials_is_at_its_maximum(prior):
    gram, _, _ = draw(np.random.default_rng(2))
    fit = fit_linear(gram, prior, np.eye(OWN), rounds=400, tolerance=1e-10)
    for a, b in [(0, 0), (1, 1), (0, 1), (3, 2)]:
        for size in (0.03, -0.03):
            other = fit.omega.copy()
            other[a, b] += size * np.sqrt(fit.omega[a, a] * fit.omega[b, b])
            other[b, a] = other[a, b]
            assert hold_omega(gram, prior, other).log_evidence < fit.log_evidence
    assert fit.omega[0, 2] == 0.0


def test_intervals_of_shared_parameters_hold_their_truth():
    prior = Prior(np.zeros(OWN + SHARED), np.full(OWN + SHARED, 0.1), np.full(OWN, 0.3), 2.0, 2)
    scores = []
    for seed in range(60):
        gram, _, (_, phi, _) = draw(np.random.default_rng(seed), trials=9)
        fit = fit_linear(gram, prior, np.eye(OWN))
        scores.append((fit.shared[OWN:] - phi) / np.sqrt(np.diag(fit.shared_covariance)[OWN:]))
    assert np.mean(np.square(scores)) == pytest.approx(1.0, abs=0.35)


def test_one_trial_without_information_returns_the_prior(prior):
    gram = np.zeros((1, OWN + SHARED + 1, OWN + SHARED + 1))
    fit = fit_linear(gram, prior, np.eye(OWN), rounds=200, tolerance=1e-9)
    np.testing.assert_allclose(fit.own[0], prior.mean[:OWN], atol=1e-9)
    diagonal = np.diag(fit.omega)
    expected = -0.5 * prior.weight * np.sum(np.log(diagonal) + prior.spread**2 / diagonal)
    assert fit.log_evidence == pytest.approx(expected, abs=1e-6)


def test_a_trial_that_hardly_shows_a_parameter_does_not_send_its_spread_to_infinity():
    """A recording without flow asks for an endless log c_p: its slope is small, its step is not."""
    design, value = np.array([100.0, 100.0, 100.0, 0.1]), np.array([10.0, -10.0, 5.0, 30.0])
    rows = np.column_stack([design, value])
    prior = Prior(np.zeros(1), np.full(1, 0.1), np.full(1, 0.4), 2.0, 1)
    fit = fit_linear(rows[:, :, None] * rows[:, None, :], prior, np.eye(1), rounds=400)
    assert fit.omega[0, 0] == pytest.approx((20.0 * prior.spread[0]) ** 2)


def test_a_fit_goes_through_a_narrow_bent_valley_in_a_few_steps():
    """η = φ² is known a thousand times better than φ is: a straight step leaves the valley."""
    trials, precise, vague = 3, 1000.0, 10.0

    def linearise(own, shared):
        gram = np.zeros((trials, 3, 3))
        for i, eta in enumerate(own[:, 0]):
            rows = np.array(
                [
                    [precise, -2 * precise * shared[0], precise * (shared[0] ** 2 - eta)],
                    [0.0, vague, vague * (1.5 - shared[0])],
                ]
            )
            gram[i] = rows.T @ rows
        return gram

    prior = Prior(np.zeros(2), np.full(2, 0.01), np.ones(1), 2.0, 1)
    bounds = SharedBounds(np.full(1, -np.inf), np.full(1, np.inf), np.full(1, 10.0))
    start = np.zeros((trials, 1)), np.zeros(1), np.eye(1)
    fit = fit_nonlinear(linearise, prior, bounds, np.full(1, 5.0), start, steps=10)
    assert fit.converged
    assert fit.shared[0] == pytest.approx(1.5, abs=0.01)
    np.testing.assert_allclose(fit.own[:, 0], fit.shared[0] ** 2, atol=1e-3)


def test_a_fit_stops_where_it_will_not_reach_its_rival():
    """φ may move by 0.05 a step, and is wanted 24 steps away."""

    def linearise(own, shared):
        slope, missing = 30.0 * shared[0] ** 2, 10.0 * (1.5**3 - shared[0] ** 3)
        rows = np.array([[10.0, 0.0, -10.0 * own[0, 0]], [0.0, slope, missing]])
        return (rows.T @ rows)[None]

    def fit(rival):
        prior = Prior(np.zeros(2), np.full(2, 0.01), np.ones(1), 2.0, 1)
        bounds = SharedBounds(np.full(1, -np.inf), np.full(1, np.inf), np.full(1, 0.05))
        start = np.zeros((1, 1)), np.full(1, 0.3), np.eye(1)
        far = np.full(1, 5.0)
        return fit_nonlinear(linearise, prior, bounds, far, start, steps=60, rival=rival)

    free = fit(-np.inf)
    assert free.converged
    assert free.shared[0] == pytest.approx(1.5, abs=0.01)
    np.testing.assert_array_equal(fit(free.log_evidence - 1.0).shared, free.shared)
    stopped = fit(free.log_evidence + 1000.0)
    assert not stopped.converged
    assert stopped.shared[0] == pytest.approx(0.3 + (BUDGET.recent + 1) * 0.05)


def test_a_fit_is_at_rest_where_its_steps_lead_back(monkeypatch):
    """The linear model asks for a step that each trial then takes back, again and again."""
    rows = np.array([[10.0, 0.0, 10.0], [0.0, 10.0, 0.0]])
    gram = np.stack([rows.T @ rows] * 3)
    prior = Prior(np.zeros(2), np.full(2, 0.01), np.ones(1), 2.0, 1)
    bounds = SharedBounds(np.full(1, -np.inf), np.full(1, np.inf), np.full(1, 10.0))
    start = np.zeros((3, 1)), np.zeros(1), np.eye(1)

    taken = []

    def lead(back, tries=1):
        taken.clear()

        def take(linearise, prior, omega, place, answer, gram, longest, region):
            taken.append(tries)
            moved = 0.0 if back else 1.0
            return Taken(place[0] + moved * answer[0], place[1][1:], gram, 1.0, tries, region)

        monkeypatch.setattr(mixed_effects_laplace, "take_step", take)
        return fit_nonlinear(
            lambda own, shared: gram, prior, bounds, np.full(1, 5.0), start, steps=12
        )

    assert lead(back=True).converged
    assert not lead(back=False).converged  # it moves on and on
    assert len(taken) == 12
    assert not lead(back=False, tries=9).converged  # and is soon given up where it must seek
    assert len(taken) == 3


@pytest.mark.parametrize("precision", np.linspace(1400.0, 1600.0, 5))
def test_an_extrapolation_stops_before_a_spread_that_vanishes(precision):
    """A shared column explains what one of two correlated parameters has of its own."""
    rng = np.random.default_rng(0)
    first, rest = 0.3 * rng.normal(size=1000), 0.01 * rng.normal(size=1000)
    zero, one = np.zeros(1000), np.ones(1000)
    rows = [[one, zero, zero, first], [zero, one, rest, 0.02 * first + rest]]
    rows = 1e4 * np.moveaxis(np.array(rows), -1, 0)
    prior = Prior(np.zeros(3), np.array([4.0, 4.0, precision]), np.array([0.3, 0.01]), 4.0, 2)
    start = np.array([[0.09, 0.0018], [0.0018, 0.000136]])
    fit = fit_linear(np.einsum("nri,nrj->nij", rows, rows), prior, start)
    least = 4.0 * 0.01**2 / 1004.0  # what the prior alone leaves
    assert least < fit.omega[1, 1] - fit.omega[0, 1] ** 2 / fit.omega[0, 0] < 2e-4
    assert fit.shared[2] > 0.95


def test_a_trial_that_shows_far_more_than_the_population_keeps_em_steady():
    """Creep of a rheometer: thousands of frames, noise of 1e-4, columns that look alike."""
    rng = np.random.default_rng(4)
    time = np.linspace(0.01, 1.0, 3000)[:, None]
    columns = 3e3 * np.hstack([time, time + 0.1 * time**2, np.sqrt(time), np.ones_like(time)])
    rows = np.hstack([columns, 3e3 * (np.log(time) + 0.01 * time), rng.normal(size=(3000, 1))])
    gram = (rows.T @ rows)[None]
    prior = Prior(np.zeros(5), np.full(5, 0.3), np.full(4, 0.3), 3.0, 4)
    omega, evidence = 0.1 * np.eye(4), []
    for _ in range(12):
        *_, value, omega = solve_gram(gram, prior, omega)
        evidence.append(value)
    assert np.all(np.diff(evidence) > -1e-4)
    assert np.abs(omega - omega.T).max() == 0.0


def test_a_shared_column_that_looks_like_own_ones_keeps_its_digits():
    """The load's scale under a constant load: it is a compliance, and only priors tell them."""
    rng = np.random.default_rng(0)
    time = np.linspace(0.01, 1.0, 3000)
    columns = 3e4 * np.column_stack([time, 1.0 + 1e-2 * time, 1.0 - np.exp(-9.0 * time)])
    rows = np.column_stack([columns, columns.sum(axis=1), rng.normal(size=3000)])
    prior = Prior(np.zeros(4), np.full(4, 4.0), np.full(3, 0.1), 2.0, 3)
    omega = np.diag([0.04, 0.09, 0.16])
    linear = hold_omega((rows.T @ rows)[None], prior, omega)
    assert np.isfinite(linear.log_evidence)
    own, shared = linear.own[0], linear.shared[3:]
    # η and φ together, μ integrated: rows of the recordings and of the priors
    root = np.linalg.inv(np.linalg.cholesky(omega + np.diag(1.0 / prior.precision[:3])))
    stack = np.vstack([rows[:, :4], np.column_stack([root, np.zeros(3)]), [[0.0, 0.0, 0.0, 2.0]]])
    right = np.linalg.qr(stack, mode="r")
    covariance = np.linalg.inv(right) @ np.linalg.inv(right).T
    assert linear.shared_covariance[3, 3] == pytest.approx(covariance[3, 3], rel=5e-3)
    answer = np.linalg.lstsq(stack, np.append(rows[:, 4], np.zeros(4)))[0]
    np.testing.assert_allclose(np.append(own, shared), answer, atol=1e-2)
