"""Pairs of leading effects, fitted whatever their linear score."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from softfinger.inference.problem import Candidate, pose_problem
from softfinger.mismatch.budget import BUDGET
from softfinger.mismatch.candidates.columns import collect_columns
from softfinger.mismatch.candidates.rank import list_pieces
from softfinger.mismatch.search import stepwise
from softfinger.mismatch.search.extend import Task
from softfinger.mismatch.search.leading_pairs import fit_leading_pairs
from softfinger.mismatch.search.shape import Shape

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


def test_each_leading_effect_is_a_start(ranked):
    problem, base, singles = ranked
    pairs = fit_leading_pairs(problem, singles, base.log_evidence, -np.inf, lambda items, _: items)
    first = {pair.model.pieces[0].effect.id for pair in pairs}
    assert 2 <= len(first) <= BUDGET.leading_pairs
    assert any(pair.fit is not None for pair in pairs)
    assert all(len(pair.model.ids) == 2 for pair in pairs)


@pytest.mark.parametrize(
    ("far", "left", "fitted"), [(-1.0, 1e9, True), (1.0, 1e9, False), (-1.0, 0.0, False)]
)
def test_pairs_are_fitted_where_much_is_left_out(ranked, monkeypatch, far, left, fitted):
    """The leading effect gains much, and a spline finds much in what it leaves."""
    problem, base, singles = ranked
    gain, asked = singles[0].log_evidence - base.log_evidence, []
    pieces = [single.model.pieces[-1] for single in singles]
    columns = collect_columns(problem, base, pieces)
    monkeypatch.setattr(stepwise, "fit_leading_pairs", lambda *_: asked.append(1) or [])
    shape = Shape(singles[0].fit, SimpleNamespace(gain=left, fit=None), 0.0)
    monkeypatch.setattr(stepwise, "measure_shape", lambda *_: shape)
    monkeypatch.setattr(stepwise, "BUDGET", replace(BUDGET, far_nats=gain + far))
    given = problem, base, pieces, {}, columns, singles, [], lambda items, _: items
    stepwise.search_effects(Task(*given), 3.0)
    assert bool(asked) is fitted
