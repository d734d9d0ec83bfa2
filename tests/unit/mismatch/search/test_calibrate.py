"""Draws of the bootstrap, where columns hide in each other."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.stats import kurtosis

from softfinger.inference.problem import Candidate, pose_problem
from softfinger.inference.tails import list_freedom
from softfinger.measurement.measure import add_components
from softfinger.mismatch.budget import BUDGET
from softfinger.mismatch.candidates.columns import collect_columns
from softfinger.mismatch.candidates.rank import list_pieces, score_pieces
from softfinger.mismatch.search import best_form, replicates
from softfinger.mismatch.search import calibrate as module
from softfinger.mismatch.search.replicates import _root, draw_products, set_apart


@pytest.fixture
def gram():
    """Gram matrix of ten columns, four of them sums of the others."""
    columns = np.random.default_rng(1).normal(size=(50, 6))
    columns = np.column_stack([columns, columns[:, :4] + columns[:, 1:5]]) * np.geomspace(
        1, 1e4, 10
    )
    return columns.T @ columns


def test_a_root_gives_the_gram_matrix_again(gram):
    root = _root(set_apart(gram))
    size = np.sqrt(np.diag(gram))
    np.testing.assert_allclose(
        root @ root.T / np.outer(size, size), gram / np.outer(size, size), atol=2 * replicates.RIDGE
    )


def test_rounding_hardly_moves_a_root(gram):
    size = np.sqrt(np.diag(gram))
    wobble = 1.0 + 1e-15 * np.random.default_rng(2).normal(size=gram.shape)
    moved = _root(set_apart(gram * 0.5 * (wobble + wobble.T))) - _root(set_apart(gram))
    assert np.abs(moved / size[:, None]).max() < 1e-4


def test_chance_gains_no_more_where_columns_hide_in_each_other(gram):
    """Ten columns explain ten squares of noise, however precise the recordings."""
    apart = set_apart(1e14 * gram)
    drawn = _root(apart) @ np.random.default_rng(3).standard_normal((10, 4000))
    size = np.sqrt(np.diag(apart))
    scaled = drawn / size[:, None]
    explained = np.sum(scaled * np.linalg.solve(apart / np.outer(size, size), scaled), axis=0)
    assert explained.mean() == pytest.approx(10.0, abs=0.3)


def test_a_replicate_whose_refit_fails_counts_by_its_score(draw_campaign, monkeypatch):
    problem, fit = pose_problem(draw_campaign(2, 0.0))
    base = Candidate(problem.base, fit, fit.log_evidence)
    pieces = [p for p in list_pieces(problem.setting)[0] if p.effect.id == "second_retardation"]
    columns = collect_columns(problem, base, pieces)

    def fail(*_):
        raise np.linalg.LinAlgError

    monkeypatch.setattr(module, "_refit", fail)
    rng = np.random.default_rng(1)
    gain = module.calibrate_false_alarms(columns, problem, base, rng, 9).gain
    assert np.isfinite(gain).all()
    assert (gain >= 0.0).all()


def test_as_many_replicates_are_drawn_as_are_asked_for(draw_campaign, monkeypatch):
    problem, fit = pose_problem(draw_campaign(2, 0.0))
    base = Candidate(problem.base, fit, fit.log_evidence)
    pieces = [p for p in list_pieces(problem.setting)[0] if p.effect.id == "second_retardation"]
    whole = set_apart(collect_columns(problem, base, pieces).bare)
    prior = problem.build_prior(base.model)
    monkeypatch.setattr(replicates, "BUDGET", replace(BUDGET, replicates=4))
    drawn = list(draw_products(whole, base, prior, np.random.default_rng(1), 9))
    assert len(drawn) == 9
    assert all(product.shape == whole.shape[:2] for product in drawn)


def test_what_is_drawn_has_the_covariance_of_the_base_model(draw_campaign):
    """Of one trial: G + G_η Ω G_ηᵀ, in columns of unit size."""
    problem, fit = pose_problem(draw_campaign(2, 0.0))
    base = Candidate(problem.base, fit, fit.log_evidence)
    pieces = [p for p in list_pieces(problem.setting)[0] if p.effect.id == "second_retardation"]
    whole = set_apart(collect_columns(problem, base, pieces).bare)
    prior = problem.build_prior(base.model)
    drawn = np.stack(list(draw_products(whole, base, prior, np.random.default_rng(1), 4000)))
    d = len(fit.omega)
    own = whole[0, :, :d]
    expected = whole[0] + own @ fit.omega @ own.T
    size = np.sqrt(np.diag(expected))
    # the mean of η, of which precise recordings show millions of sds, is taken off
    np.testing.assert_allclose(drawn[:, 0].mean(axis=0) / size, 0.0, atol=0.1)
    seen = np.cov(drawn[:, 0] / size, rowvar=False)
    np.testing.assert_allclose(seen, expected / np.outer(size, size), atol=0.1)


def test_noise_with_tails_is_drawn_with_them():
    """Of the covariance of normal noise, and further out where a row is a single frame."""
    rows = np.random.default_rng(3).standard_normal((2, 4, 2))
    rows[:, 1:] *= 0.2  # one row bears most
    freedom, rng = np.array([4.5, 4.5, 400.0, 400.0]), np.random.default_rng(4)
    drawn = replicates._draw_noise(None, [(trial, freedom) for trial in rows], rng, 100_000)
    assert drawn.shape == (2, 2, 100_000)
    for trial, seen in zip(rows, drawn, strict=True):
        np.testing.assert_allclose(np.cov(seen), trial.T @ trial, rtol=0.1, atol=0.02)
        assert (kurtosis(seen, axis=1) > 2.0).all()


@pytest.mark.parametrize("tailed", [False, True])
def test_chance_has_the_tails_of_the_recordings(draw_campaign, monkeypatch, tailed):
    """The rows that it is drawn with give the Gram matrices that score it."""
    problem, fit = pose_problem(draw_campaign(3, 0.0))
    if tailed:
        noise = add_components(problem.noise, {"heavy_tails": 3.0}, {"heavy_tails": 50.0})
        problem = replace(problem, noise=noise)
    base = Candidate(problem.base, fit, fit.log_evidence)
    pieces = [p for p in list_pieces(problem.setting)[0] if p.effect.id == "camera_delay"]
    columns = collect_columns(problem, base, pieces, list_freedom(problem))
    seen = []

    def draw(whole, base, prior, rng, replicates, tails):
        seen.extend(tails)
        return draw_products(whole, base, prior, rng, replicates, tails)

    monkeypatch.setattr(module, "draw_products", draw)
    module.calibrate_false_alarms(columns, problem, base, np.random.default_rng(1), 3)
    assert len(seen) == (len(problem.trials.name) if tailed else 0)
    for (rows, freedom), gram in zip(seen, columns.bare, strict=False):
        np.testing.assert_allclose(rows.T @ rows, gram, rtol=1e-6)
        assert len(freedom) == len(rows)
        assert freedom.min() == 3.0  # of a frame by itself


def test_what_joints_have_in_common_is_drawn_with_them():
    """Ω is diagonal, and ten precise trials move two joints alike: so does a replicate."""
    rng, trials = np.random.default_rng(2), 10
    own = np.repeat(rng.standard_normal((trials, 1)), 2, axis=1)
    nothing = 1e-12 * np.eye(2)
    fit = SimpleNamespace(
        own=own, mean=own.mean(axis=0), own_covariance=np.stack([nothing] * trials),
        mean_covariance=nothing, omega=np.eye(2),
    )  # fmt: skip
    prior = SimpleNamespace(spread=np.ones(2), weight=2.0)
    whole = np.zeros((trials, 3, 3))
    drawn = replicates._draw_own(whole, SimpleNamespace(fit=fit), prior, rng, 400)
    together = np.corrcoef(drawn.reshape(-1, 2), rowvar=False)[0, 1]
    assert together == pytest.approx(10 / 12, abs=0.1)
    assert np.mean(drawn**2) == pytest.approx(1.0, abs=0.3)
    assert abs(np.mean(drawn)) < 0.1


def test_a_covariance_that_rounding_made_singular_has_a_root():
    one = np.array([[4.0, 2.0], [2.0, 1.0 - 1e-15]])  # no Cholesky factor
    with pytest.raises(np.linalg.LinAlgError):
        np.linalg.cholesky(one)
    root = replicates._root_of_covariance(np.stack([one, np.diag([9.0, 1e-20])]))
    expected = np.stack([one, np.diag([9.0, 1e-20])])
    np.testing.assert_allclose(root @ root.swapaxes(1, 2), expected, rtol=1e-7, atol=1e-30)


def test_a_form_drops_the_places_that_it_does_not_need():
    """As where the recordings are scored; chance gains more by the choice."""
    place, wide = np.repeat([0, 1, 2], 2), np.full(6, 2.0)
    positive = np.array([False, True] * 3)
    seen = 30.0 * np.eye(6)
    pull = np.array([20.0, 25.0, 0.5, -12.0, -0.3, 0.2])
    every, _ = best_form._weigh(seen, pull, wide, positive, np.ones(6, bool))
    gain, kept = best_form._drop_places(seen, pull, wide, positive, place, every)
    assert kept.tolist() == [True, True, False, False, False, False]
    assert gain == best_form._weigh(seen, pull, wide, positive, kept)[0] > every + 3.0


def test_a_replicate_is_scored_as_the_recordings_are(draw_campaign):
    problem, fit = pose_problem(draw_campaign(3, 0.0))
    base = Candidate(problem.base, fit, fit.log_evidence)
    wanted = {"temperature", "fatigue_softening", "load_gain", "session_jump"}
    pieces = [p for p in list_pieces(problem.setting)[0] if p.effect.id in wanted]
    columns = collect_columns(problem, base, pieces)
    found = score_pieces(problem, base, columns)[0]
    d = len(fit.omega)
    gram = np.delete(np.delete(columns.gram, np.s_[d : columns.own], 1), np.s_[d : columns.own], 2)
    away = np.zeros((len(gram), gram.shape[1] - 1))
    away[:, :d] = fit.own - fit.mean
    product = gram[:, :-1, -1] + np.einsum("tab,tb->ta", gram[:, :-1, :-1], away)
    prior = problem.build_prior(base.model)
    prior = prior._replace(mean=prior.mean[:d] - fit.mean, precision=prior.precision[:d])
    squares = best_form.gather_squares(columns, columns.bare, d)
    best, _ = best_form.find_best_form(columns, squares, product, prior, fit.omega)
    (block,) = [b for b in columns.blocks if np.isin(best.columns, b.columns).all()]
    assert block.model.pieces[-1].label == found.model.pieces[-1].label
    assert best.gain == pytest.approx(found.gain, abs=0.3)
