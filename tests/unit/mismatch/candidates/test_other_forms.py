import pytest

from softfinger.inference.problem import Candidate, pose_problem
from softfinger.mechanics.effects.model import EffectModel
from softfinger.mismatch.candidates.other_forms import find_other_form, keep_leading, swap_forms
from softfinger.mismatch.candidates.rank import go_on, list_pieces


@pytest.fixture(scope="module")
def posed(draw_campaign):
    """A campaign whose second element goes with each trial's stiffness, and both forms fitted."""
    problem, fit = pose_problem(draw_campaign(1, 0.15))
    base = Candidate(problem.base, fit, fit.log_evidence)
    pieces = [
        piece
        for piece in list_pieces(problem.setting)[0]
        if piece.effect.id == "second_retardation" and not piece.form.is_free
    ]
    fitted = {}
    for piece in pieces:
        model = base.model.extend(piece)
        shared = model.place_start(0, model.list_starts(0)[2])
        fit = problem.fit(model, (base.fit.own, shared, base.fit.omega))
        fitted[piece.form.name] = Candidate(model, fit, fit.log_evidence)
    return problem, pieces, fitted


def test_a_set_is_tried_in_its_other_forms_from_where_it_was_found(posed):
    problem, pieces, fitted = posed
    better, worse = fitted["proportional"], fitted["own_compliance"]
    assert better.log_evidence > worse.log_evidence + 1.0
    swapped = swap_forms(problem, worse, pieces)
    assert swapped[-1].model.pieces[0].form.name == "proportional"
    assert swapped[-1].log_evidence == pytest.approx(better.log_evidence, abs=0.2)
    assert swap_forms(problem, better, pieces) == []


def test_other_forms_are_left_where_the_time_is_over(posed):
    problem, pieces, fitted = posed
    assert swap_forms(problem, fitted["own_compliance"], pieces, lambda *_: []) == []


def test_the_other_form_is_the_best_of_the_same_effects(posed):
    _, _, fitted = posed
    better, worse = fitted["proportional"], fitted["own_compliance"]
    unfitted = Candidate(worse.model, None, better.log_evidence + 100.0)
    assert find_other_form([better, worse, unfitted], better) is worse
    assert find_other_form([better, unfitted], better) is None


def test_forms_of_the_effects_that_say_most_are_kept(posed):
    problem, _, fitted = posed
    best = fitted["proportional"]
    every = [p for p in list_pieces(problem.setting)[0] if p.effect.id != "second_retardation"]
    names = list(dict.fromkeys(p.effect.id for p in every))
    first = {p.effect.id: p for p in reversed(every)}
    larger = [Candidate(best.model.extend(first[n]), None, -float(k)) for k, n in enumerate(names)]
    larger.append(Candidate(EffectModel(problem.setting, (first[names[-1]],)), None, 50.0))
    kept = keep_leading(every, larger, best)
    assert {p.effect.id for p in kept} == set(names[:4])


def test_a_fit_that_goes_on_counts_its_gain_from_where_it_began(posed):
    problem, pieces, fitted = posed
    model, there = problem.base.extend(pieces[0]), fitted[pieces[0].form.name].fit
    begun = problem.fit(model, (there.own, there.shared + 0.3, there.omega), steps=1)
    more = go_on(problem, model, begun)
    assert not begun.converged
    assert more.converged
    assert more.first == begun.first
