"""Pairs of leading effects, fitted whatever their linear score."""

from dataclasses import replace

import pytest

from softfinger.inference.problem import Candidate, pose_problem
from softfinger.mismatch.budget import BUDGET
from softfinger.mismatch.candidates.rank import list_pieces
from softfinger.mismatch.search import leading_pairs as module

FORMS = {
    ("second_retardation", "proportional"),
    ("second_retardation", "own_compliance"),
    ("stress_nonlinear_flow", "sinh"),
    ("actuator_lag", "first_order"),
}


@pytest.fixture(scope="module")
def ranked(draw_campaign):
    """A campaign with creep, and fits of single effects to it."""
    problem, fit = pose_problem(draw_campaign(3, 0.5))
    base = Candidate(problem.base, fit, fit.log_evidence)
    singles = []
    for piece in list_pieces(problem.setting)[0]:
        if (piece.effect.id, piece.form.name) in FORMS:
            model = base.model.extend(piece)
            start = fit.own, model.place_start(0, model.list_starts(0)[0]), fit.omega
            found = problem.fit(model, start, first=fit.first)
            singles.append(Candidate(model, found, found.log_evidence))
    return problem, base, sorted(singles, key=lambda c: -c.log_evidence)


def fit_pairs(ranked, monkeypatch, far_nats, p_value=0.0):
    problem, base, singles = ranked
    monkeypatch.setattr(module, "compute_excess", lambda *_: (0.0, p_value))
    monkeypatch.setattr(module, "BUDGET", replace(BUDGET, far_nats=far_nats))
    return module.fit_leading_pairs(
        problem, base, singles, base.log_evidence, lambda items, _: items
    )


def test_pairs_are_fitted_where_much_is_left_out(ranked, monkeypatch):
    _, base, singles = ranked
    gain = singles[0].log_evidence - base.log_evidence
    assert fit_pairs(ranked, monkeypatch, gain + 1.0) == []
    pairs = fit_pairs(ranked, monkeypatch, gain - 1.0)
    assert any(pair.fit is not None for pair in pairs)
    assert all(len(pair.model.ids) == 2 for pair in pairs)


def test_none_is_fitted_where_the_best_leaves_nothing(ranked, monkeypatch):
    assert fit_pairs(ranked, monkeypatch, 0.0, p_value=0.5) == []


def test_each_leading_effect_is_a_start(ranked, monkeypatch):
    pairs = fit_pairs(ranked, monkeypatch, 0.0)
    first = {pair.model.pieces[0].effect.id for pair in pairs}
    assert 2 <= len(first) <= BUDGET.leading_pairs
