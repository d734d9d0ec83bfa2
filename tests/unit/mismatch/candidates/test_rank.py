from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from softfinger.inference.mixed_effects import Prior
from softfinger.inference.mixed_effects_linearised import SharedBounds
from softfinger.inference.problem import Candidate, pose_problem
from softfinger.mechanics.effects.model import EffectModel
from softfinger.mismatch.candidates import rank
from softfinger.mismatch.candidates.columns import collect_columns
from softfinger.mismatch.candidates.linearised import Linearised, evaluate_linearised
from softfinger.mismatch.candidates.rank import (
    Score,
    fit_scored,
    list_pieces,
    rank_pieces,
    score_pieces,
)
from softfinger.mismatch.search.shape import measure_shape
from softfinger.mismatch.search.stepwise import require_gain


@pytest.fixture(scope="module")
def posed(draw_campaign):
    problem, fit = pose_problem(draw_campaign(1, 0.15))
    return problem, Candidate(problem.base, fit, fit.log_evidence)


def test_a_block_is_linearised_as_the_model_itself_at_its_start(posed):
    problem, base = posed
    pieces = [p for p in list_pieces(problem.setting)[0] if p.form.name == "proportional"]
    columns = collect_columns(problem, base, pieces)
    block = columns.blocks[1]
    seen = np.array([0, 1, 2, 3, 4, 6])  # the retardation time of a share of nothing has no slope
    expected, found = (
        gram[:, seen[:, None], seen]
        for gram in (
            problem.linearise(block.model, base.fit.own, block.shared),
            columns.linearise(block),
        )
    )
    size = np.sqrt(np.einsum("tii->ti", expected).max(axis=0))
    np.testing.assert_allclose(
        found / np.outer(size, size), expected / np.outer(size, size), atol=2e-2
    )


def test_the_true_effect_scores_best(posed):
    problem, base = posed
    pieces = list_pieces(problem.setting)[0]
    scores = score_pieces(problem, base, collect_columns(problem, base, pieces))
    assert scores[0].effect in ("second_retardation", "fractional_creep")
    gains = [score.gain for score in scores]
    assert gains == sorted(gains, reverse=True)


def test_what_an_unfinished_fit_promises_is_no_gain_of_a_form(draw_campaign):
    problem, fit = pose_problem(draw_campaign(1, 0.0))
    away = fit.own + 0.2 * np.sin(np.arange(fit.own.size).reshape(fit.own.shape))
    begun = problem.fit(problem.base, (away, fit.shared, fit.omega), steps=1)
    assert begun.log_evidence < fit.log_evidence - 10.0
    origin = Candidate(problem.base, begun, begun.log_evidence)
    scores = score_pieces(
        problem, origin, collect_columns(problem, origin, list_pieces(problem.setting)[0])
    )
    assert scores[0].gain < 5.0


def test_a_further_effect_must_bring_more_than_errors_of_textbook_forms(posed):
    problem, base = posed
    pieces = list_pieces(problem.setting)[0]
    chance = 3.0 + np.log(len({piece.effect.id for piece in pieces}))
    for effect, error in {"camera_delay": 5.0, "strain_stiffening": 0.0}.items():
        piece = next(piece for piece in pieces if piece.effect.id == effect)
        best = base._replace(model=base.model.extend(piece))
        assert require_gain(3.0, 1000.0, pieces, best) == pytest.approx(chance + error)


def test_a_shape_is_a_rival_before_the_true_effect_is_there_and_not_after(posed):
    problem, base = posed
    pieces = [p for p in list_pieces(problem.setting)[0] if p.effect.id == "second_retardation"]
    columns = collect_columns(problem, base, pieces)
    repaired = rank_pieces(problem, base, columns, lambda items, _: items)[0][0]
    gain = repaired.log_evidence - base.log_evidence
    assert 15.0 < measure_shape(problem, base).gain < gain  # its few numbers say more than a spline
    assert measure_shape(problem, repaired).gain < 1.0


def test_a_local_form_leaves_the_other_joints_alone(posed):
    wide = replace(
        posed[0].setting,
        joints=3,
        stiffness=np.full(3, 0.1),
        reach=np.ones(3),
        memory=np.zeros((posed[0].setting.trials, 3)),
    )
    pieces = [p for p in list_pieces(wide)[0] if p.label == "yield_threshold/excess/2"]
    model = EffectModel(wide, (pieces[0],))
    slots = model.fill_slots(np.array([0.01]))
    changed = np.ptp(slots.joint, axis=1).any(axis=0)
    acting = np.argwhere(slots.joint != EffectModel(wide).fill_slots(np.zeros(0)).joint)
    assert changed.any()
    assert set(acting[:, 1]) == {1}
    assert pieces[0].joints == [2]


class Form(str):
    """A model's label, of one effect."""

    __slots__ = ()
    entries = ()

    @property
    def ids(self):
        return frozenset({self[0]})


class Misled:
    """A problem whose leading form gains much while it moves, and nothing once it rests."""

    def __init__(self, fit):
        self.fit_to, self.calls = fit, []

    def fit(self, model, start, *, steps=None, first=0.0, rival=0.0):
        self.calls.append((model, steps))
        gain, converged = {
            ("lead", True): (300.0, False),
            ("lead", False): (-50.0, True),
            ("true", True): (80.0, True),
        }[model, steps is not None]
        return self.fit_to._replace(log_evidence=gain, converged=converged)


def test_a_fit_that_does_not_rest_sets_no_measure_for_others(posed, monkeypatch):
    _, base = posed
    monkeypatch.setattr(rank, "prune", lambda problem, candidate: candidate)
    monkeypatch.setattr(Score, "effect", property(lambda score: score.model))
    given = (("lead", 100.0), ("true", 75.0))
    scores = [Score(Form(name), gain, np.zeros(1)) for name, gain in given]
    origin = base._replace(log_evidence=0.0)
    found = fit_scored(Misled(base.fit), origin, scores, lambda items, _: items)
    assert [(c.model, c.log_evidence) for c in found if c.fit is not None] == [("true", 80.0)]


class Slight:
    """A problem in which every form gains 6 nats, and says so at once."""

    def __init__(self, fit):
        self.rest, self.calls = fit._replace(log_evidence=6.0, converged=True), 0

    def fit(self, model, start, **how):
        self.calls += 1
        return self.rest


@pytest.mark.parametrize(("floor", "fitted"), [(-np.inf, 6), (30.0, 4)])
def test_only_leading_effects_are_fitted_where_none_comes_near_what_is_asked(
    posed, monkeypatch, floor, fitted
):
    _, base = posed
    monkeypatch.setattr(rank, "prune", lambda problem, candidate: candidate)
    monkeypatch.setattr(Score, "effect", property(lambda score: score.model))
    scores = [Score(Form(name), 5.0, np.zeros(1)) for name in "abcdef"]
    origin = base._replace(log_evidence=0.0)
    problem = Slight(base.fit)
    found = fit_scored(problem, origin, scores, lambda items, _: items, floor)
    assert problem.calls == fitted
    assert len(found) == 6


class Slow:
    """A problem whose forms rest 50 nats above where they are after the first steps."""

    def __init__(self, fit):
        self.fit_to, self.rested = fit, []

    def fit(self, model, start, *, steps=None, first=0.0, rival=0.0):
        gain = {"a1": 900.0, "a2": 850.0, "a3": 840.0, "a4": 890.0, "b1": 700.0}[model]
        if steps is None:
            self.rested.append(str(model))
            gain += 50.0
        return self.fit_to._replace(log_evidence=gain, converged=steps is None)


def test_only_two_forms_of_the_same_effects_go_on_far_behind_the_best(posed, monkeypatch):
    """Of `a` three are near the best or second; `b` is another effect."""
    _, base = posed
    pruned = []
    monkeypatch.setattr(rank, "prune", lambda _, candidate: pruned.append(1) or candidate)
    monkeypatch.setattr(Score, "effect", property(lambda score: score.model[0]))
    names = ("a1", "a2", "a3", "a4", "b1")
    scores = [Score(Form(name), 900.0, np.zeros(1)) for name in names]
    problem = Slow(base.fit)
    found = fit_scored(problem, base._replace(log_evidence=0.0), scores, lambda items, _: items)
    fitted = [str(c.model) for c in found if c.fit is not None]
    assert fitted == ["a1", "a4", "b1"]
    assert sorted(set(problem.rested)) == ["a1", "a4", "b1"]
    assert len(pruned) == 2


class Far(Form):
    """A form with one far start."""

    __slots__ = ()
    entries = (SimpleNamespace(parameter=SimpleNamespace(name="far", far=(2.0,))),)


def test_a_fit_from_a_far_start_may_stop_where_it_falls_behind(posed, monkeypatch):
    """Where others reach 1000 nats, half of that must be reached to go on."""
    _, base = posed
    rivals = []

    def fit(model, start, *, steps=None, first=0.0, rival=-np.inf):
        rivals.append(rival)
        return base.fit._replace(log_evidence=400.0, first=0.0, converged=steps is None)

    monkeypatch.setattr(rank, "prune", lambda problem, candidate: candidate)
    monkeypatch.setattr(Score, "effect", property(lambda score: score.model))
    none = base.fit._replace(shared=np.zeros(0), first=0.0)
    origin = base._replace(log_evidence=0.0, fit=none)
    scores = [Score(Far("far"), 900.0, np.zeros(1))]
    fit_scored(SimpleNamespace(fit=fit), origin, scores, lambda items, _: items, 1000.0)
    assert rivals == [500.0, 500.0, 500.0]  # the first steps, on from there, and from afar


@pytest.mark.parametrize(("others", "goes_on_to"), [(0.0, 1000.0), (1001.0, 800.8)])
def test_a_set_goes_on_only_to_what_is_asked(posed, monkeypatch, others, goes_on_to):
    """Once others of its kind reach what is asked, those that compete with them go on too."""
    _, base = posed
    rivals = []

    def fit(model, start, *, steps=None, first=0.0, rival=-np.inf):
        rivals.append(rival)
        return base.fit._replace(log_evidence=900.0, converged=steps is None)

    monkeypatch.setattr(rank, "prune", lambda problem, candidate: candidate)
    monkeypatch.setattr(rank, "DECISIONS", replace(rank.DECISIONS, rival_share=0.2))
    monkeypatch.setattr(Score, "effect", property(lambda score: score.model))
    origin, quiet = base._replace(log_evidence=0.0), lambda items, _: items
    scores, problem = [Score(Form("pair"), 900.0, np.zeros(1))], SimpleNamespace(fit=fit)
    fit_scored(problem, origin, scores, quiet, max(1000.0, others), 1000.0)
    assert rivals[1:] == [pytest.approx(goes_on_to)]


def test_a_linear_model_that_cannot_be_solved_has_no_evidence():
    """Numbers of one form may leave their range; the other forms are still ranked."""
    model = SimpleNamespace()
    problem = SimpleNamespace(
        build_prior=lambda _: Prior(np.zeros(2), np.ones(2), np.ones(1), 2.0, 1),
        build_bounds=lambda _: SharedBounds(np.full(1, -1.0), np.ones(1), np.ones(1)),
    )
    there = Linearised(np.full((2, 3, 3), np.nan), np.zeros((2, 1)), np.zeros(1), np.eye(1))
    assert evaluate_linearised(problem, model, there, 0) == -np.inf


def test_a_slow_lag_is_found_where_the_joint_took_its_part(slow_lag, monkeypatch):
    """The fit that starts near the base has lag and joint the wrong way round."""
    problem, fit = pose_problem(slow_lag)
    base = Candidate(problem.base, fit, fit.log_evidence)
    lags = [p for p in list_pieces(problem.setting)[0] if p.form.name == "first_order"]
    scores = score_pieces(problem, base, collect_columns(problem, base, lags))
    found = fit_scored(problem, base, scores, lambda items, _: items)[0]
    assert found.fit.shared[0] == pytest.approx(0.3, rel=0.05)
    monkeypatch.setattr(rank, "BUDGET", replace(rank.BUDGET, far_nats=np.inf))
    near = fit_scored(problem, base, scores, lambda items, _: items)[0]
    assert near.log_evidence < found.log_evidence - 20.0


def test_play_is_found_in_each_joint_though_the_damper_took_its_part(late_links, monkeypatch):
    """No linear model near a fit without play has use for it."""
    problem, fit = pose_problem(late_links)
    base = Candidate(problem.base, fit, fit.log_evidence)
    plays = [p for p in list_pieces(problem.setting)[0] if p.form.name == "backlash"]
    scores = score_pieces(problem, base, collect_columns(problem, base, plays))
    assert all(score.gain < 0.0 for score in scores)
    others = fit.log_evidence + rank.BUDGET.far_nats
    found = fit_scored(problem, base, scores, lambda items, _: items, others)[0]
    np.testing.assert_allclose(found.fit.shared, 0.1, rtol=0.05)
