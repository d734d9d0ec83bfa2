"""Creep in time and a law of the rate, where each trial has one load."""

from dataclasses import replace

import numpy as np
import pytest

from softfinger.inference.problem import Candidate
from softfinger.mechanics.effects import list_effects
from softfinger.mechanics.effects.model import Piece
from softfinger.mismatch.candidates.elsewhere import list_elsewhere
from softfinger.mismatch.candidates.rank import list_pieces
from softfinger.mismatch.search.one_load import share_with_creep
from softfinger.mismatch.search.settle import weigh_models

THIN, CREEP = frozenset({"thinning_damper"}), ("second_retardation", "fractional_creep")


def end_with_thinning(named, levels):
    """A search that ends with a thinning damper, as fitted to a second retardation."""
    problem = replace(named.problem, setting=replace(named.problem.setting, levels=levels))
    base = named.search.base
    effect = list_effects()["thinning_damper"]
    model = base.model.extend(Piece(effect, effect.list_forms(problem.setting)[0], ((0,),)))
    fit = problem.fit(model, (base.fit.own, np.full(1, 0.1), base.fit.omega))
    thin = Candidate(model, fit, fit.log_evidence)
    return problem, named.search._replace(best=thin, candidates=[thin], rejected=[])


@pytest.fixture(scope="module")
def shared(named):
    problem, search = end_with_thinning(named, levels=False)
    return search, share_with_creep(problem, search)


def test_under_one_load_a_law_of_the_rate_shares_its_evidence_with_creep(shared):
    before, after = shared
    sets = weigh_models(after.base, after.candidates).sets
    creep = sum(sets[frozenset({name})] for name in CREEP)
    assert sets[THIN] == pytest.approx(creep)
    assert sets[THIN] < 0.51
    assert after.best is before.best


def test_the_creep_that_shares_is_the_one_that_fits(shared):
    second, fractional = (
        next(c for c in shared[1].candidates if c.model.ids == {name}) for name in CREEP
    )
    assert second.log_evidence > fractional.log_evidence
    assert second.fit.log_evidence > shared[0].best.log_evidence  # it is the truth


def test_under_several_loads_a_law_of_the_rate_stays_what_it_is(named):
    problem, search = end_with_thinning(named, levels=True)
    assert share_with_creep(problem, search) is search


@pytest.mark.parametrize("levels", [False, True])
def test_softening_and_creep_are_claimed_together_only_under_several_loads(named, levels):
    problem = replace(named.problem, setting=replace(named.problem.setting, levels=levels))
    creep = named.search.best.model
    assert creep.ids <= set(CREEP)
    beside = {p.effect.id for p in list_elsewhere(problem, creep, list_pieces(problem.setting)[0])}
    assert ("softening_within_trial" in beside) == levels


def test_creep_stays_what_it_is(named):
    problem = replace(named.problem, setting=replace(named.problem.setting, levels=False))
    assert share_with_creep(problem, named.search) is named.search


@pytest.mark.parametrize("levels", [False, True])
def test_no_effect_joins_another_of_its_place(named, levels):
    problem = replace(named.problem, setting=replace(named.problem.setting, levels=levels))
    pieces, _ = list_pieces(problem.setting)
    model = problem.base.extend(next(p for p in pieces if p.effect.id == "fractional_creep"))
    others = {p.effect.id for p in list_elsewhere(problem, model, pieces)}
    assert not others & set(CREEP)
    assert ("thinning_damper" in others) == levels
    assert "strain_stiffening" in others
    # what a repaired base model has is no law that is sought
    repaired = replace(problem, repaired=model)
    assert "second_retardation" in {p.effect.id for p in list_elsewhere(repaired, model, pieces)}
