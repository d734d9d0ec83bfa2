"""What a free law is told to be."""

from dataclasses import replace

import numpy as np
import pytest

from softfinger.inference.problem import Candidate
from softfinger.mechanics.effects import list_effects
from softfinger.mechanics.effects.model import Piece
from softfinger.mismatch.candidates.rank import list_pieces
from softfinger.mismatch.search import species as module
from softfinger.mismatch.search.species import list_kin, name_species, weigh_species


def test_the_nearest_textbook_is_the_likelier_and_a_tie_is_a_tie():
    near, far = weigh_species(np.array([10.0, 1000.0]), 6)
    assert near > 0.999
    assert weigh_species(np.array([50.0, 50.0]), 6) == pytest.approx([0.5, 0.5])
    assert near + far == pytest.approx(1.0)
    assert weigh_species(np.array([np.inf, np.inf]), 6) == pytest.approx([0.5, 0.5])


def test_a_law_that_effects_share_is_tried_once(named):
    pieces, _ = list_pieces(named.problem.setting)
    tried = [(p.effect.id, p.form.name) for p in pieces if p.form.kin == "creep"]
    forms = ("free", "free_in_own_time")
    assert tried == [("second_retardation", form) for form in forms]
    free = next(p.form for p in pieces if p.form.kin)
    kin = list_kin(named.problem, free)
    assert [one.effect.id for one in kin] == ["second_retardation", "fractional_creep"]
    assert not any(form.kin for one in kin for form in one.textbook)


def free_creep(named):
    """The search that ends with the free spectrum, as fitted to one more Voigt element."""
    problem, best = named.problem, named.search.best
    effect = list_effects()["second_retardation"]
    form = next(f for f in effect.list_forms(problem.setting) if f.kin)
    model = replace(best.model, pieces=(Piece(effect, form, ((0,),)),))
    start = best.fit.own, np.full(len(model.entries), 0.01), best.fit.omega
    fit = problem.fit(model, start, first=best.fit.first)
    free = Candidate(model, fit, fit.log_evidence)
    return named.search._replace(best=free, candidates=[free])


def test_a_spectrum_of_one_peak_is_a_second_retardation(named):
    search = free_creep(named)
    told = name_species(named.problem, search)
    assert told.best.model.ids == {"second_retardation"}
    assert told.best.fit is search.best.fit
    second, fractional = told.candidates
    assert second.log_evidence == pytest.approx(search.best.log_evidence, abs=0.1)
    assert fractional.log_evidence < second.log_evidence - 3.0


def test_a_spectrum_as_near_to_both_is_shared_by_both(named, monkeypatch):
    monkeypatch.setattr(module, "_measure_loss", lambda *_: 40.0)
    told = name_species(named.problem, free_creep(named))
    assert {frozenset(c.model.ids) for c in told.candidates} == {
        frozenset({"second_retardation"}), frozenset({"fractional_creep"}),
    }  # fmt: skip
    first, second = told.candidates
    assert first.log_evidence == second.log_evidence


def test_a_textbook_form_needs_no_species(named):
    assert name_species(named.problem, named.search) is named.search
