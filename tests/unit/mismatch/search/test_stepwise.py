"""How an effect is searched for, and how a free-form term stands against what was found."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from softfinger.inference.problem import Candidate, pose_problem
from softfinger.mechanics.effects import list_effects
from softfinger.mechanics.effects.model import Piece
from softfinger.mismatch.candidates.columns import collect_columns
from softfinger.mismatch.candidates.elsewhere import list_compatible
from softfinger.mismatch.candidates.rank import list_pieces
from softfinger.mismatch.search import extend as module
from softfinger.mismatch.search import hidden, stepwise
from softfinger.mismatch.search.extend import Task
from softfinger.mismatch.search.shape import Shape, allow_rest
from softfinger.mismatch.search.stepwise import hold_against_shape, search_effects


def hold(named, gain):
    """Hold what was found, which explains 100 nats, against a shape alone of some gain."""
    found = named.search
    base, best = (
        c._replace(log_evidence=evidence)
        for c, evidence in ((found.base, 0.0), (found.best, 100.0))
    )
    free = named.search.shape.free or named.search.alone.free
    alone = Shape(base.fit, free._replace(gain=gain))
    search = found._replace(base=base, best=best, alone=alone)
    return search, hold_against_shape(named.problem, search)


@pytest.mark.parametrize("gain", [60.0, 105.0, 114.0])
def test_effects_stay_where_a_shape_alone_says_little_more(named, gain):
    search, held = hold(named, gain)
    assert held.best is search.best
    assert held.shape is search.shape


def test_a_shape_alone_that_says_clearly_more_takes_the_place_of_effects(named):
    search, held = hold(named, 116.0)
    assert held.best is search.base
    assert held.shape is held.alone is search.alone


def test_what_effects_may_leave_grows_with_what_they_explain():
    assert allow_rest(1000.0, 5.0) == 50.0
    assert allow_rest(4.0, 9.0) == 9.0
    assert 6.9 < allow_rest(4.0, 5.0) < 7.0


@pytest.mark.parametrize("tried", ["strain_stiffening", "second_retardation"])
def test_the_partner_of_a_pair_that_was_not_tried_with_others_is(named, tried, monkeypatch):
    """The campaign has a second retardation; whatever stands beside it stands for nothing."""
    problem, best = named.problem, named.search.best
    stiffer = list_effects()["strain_stiffening"]
    form = next(f for f in stiffer.build_forms(problem.setting) if len(f.parameters) == 1)
    model = best.model.extend(Piece(stiffer, form, ((0,),)))
    start = best.fit.own, np.append(best.fit.shared, 0.01), best.fit.omega
    fit = problem.fit(model, start, first=best.fit.first)
    pair = best._replace(model=model, fit=fit, log_evidence=fit.log_evidence)
    assert pair.model.ids == {"second_retardation", "strain_stiffening"}
    led = []
    monkeypatch.setattr(module, "extend", lambda _, alone, *__: led.append(alone) or [alone])
    task = Task(problem, named.search.base, [], {}, None, [], [], None)
    found = module.try_partners(task, pair, {frozenset({tried})})
    assert [c.model.ids for c in led] == [pair.model.ids - {tried}]
    assert found == led
    assert led[0].fit.converged


def test_effects_that_claim_one_slot_are_not_tried_together(named):
    """Two widths of friction, say: a slot that is not 0 where it is absent."""
    problem, best = named.problem, named.search.best
    effect = list_effects()["fractional_creep"]
    form = next(f for f in effect.build_forms(problem.setting) if f.name == "instead_of_dashpot")
    one, other = Piece(effect, form, ()), Piece(replace(effect, id="another"), form, ())
    found = best._replace(model=replace(best.model, pieces=(one,)))
    assert list_compatible(found, [other]) == []


def test_where_no_single_effect_competes_pairs_are_tried_and_the_needless_dropped(draw_campaign):
    """Singles are withheld; the campaign has a second retardation."""
    problem, fit = pose_problem(draw_campaign(1, 0.15))
    base = Candidate(problem.base, fit, fit.log_evidence)
    wanted = ("second_retardation", "lens_distortion", "strain_stiffening")
    pieces = [p for p in list_pieces(problem.setting)[0] if p.effect.id in wanted]
    columns = collect_columns(problem, base, pieces)
    task = Task(problem, base, pieces, {}, columns, [], [], lambda items, _: items)
    found = search_effects(task, 5.0)
    assert found.best.model.ids == {"second_retardation"}
    assert found.first_gain > 15.0
    assert any(len(c.model.ids) == 2 for c in found.candidates)
    beside = search_effects(task, 5.0, worth=1e4)
    assert beside.candidates == []  # far behind what is known already


@pytest.mark.parametrize(("worth", "sought"), [(140.0, True), (1000.0, False)])
def test_nothing_is_added_to_a_pair_far_behind_what_is_known(monkeypatch, worth, sought):
    def candidate(nats, *ids):
        model = SimpleNamespace(ids=frozenset(ids), pieces=())
        return SimpleNamespace(log_evidence=nats, model=model, fit=object())

    single, pair = candidate(100.0, "gravity"), candidate(150.0, "gravity", "inertia")
    added = []
    for name, answer in {
        "_enlarge": [pair],
        "_face_finer": single,
        "measure_shape": Shape(single.fit, None),
        "list_finer": [],
        "try_partners": [],
        "eliminate": pair,
    }.items():
        monkeypatch.setattr(stepwise, name, lambda *_, answer=answer: answer)
    monkeypatch.setattr(stepwise, "swap_forms", lambda *_: added.append(1) or [])
    monkeypatch.setattr(stepwise, "BUDGET", replace(stepwise.BUDGET, most_effects=2))
    task = Task(None, candidate(0.0), [], {}, None, [single], [], None)
    found = search_effects(task, 5.0, worth)
    assert found.best is pair
    assert pair in found.candidates
    assert bool(added) is sought


@pytest.mark.parametrize(("added", "left", "sought"), [(4, 4, 0), (4, 9, 1), (9, 4, 1)])
def test_pairs_are_sought_only_where_one_effect_leaves_something(monkeypatch, added, left, sought):
    """What is added to it gains as much as chance, and so does a free-form term."""

    def candidate(nats, *ids):
        model = SimpleNamespace(ids=frozenset(ids), pieces=())
        return SimpleNamespace(log_evidence=nats, model=model, fit=1)

    one, pair = candidate(100.0, "gravity"), candidate(100.0 + added, "gravity", "inertia")
    shape, asked = Shape(one.fit, SimpleNamespace(gain=left)), []
    monkeypatch.setattr(stepwise, "extend", lambda *_: [pair])
    monkeypatch.setattr(stepwise, "measure_shape", lambda *_: shape)
    monkeypatch.setattr(stepwise, "find_other_form", lambda *_: None)
    monkeypatch.setattr(stepwise, "require_gain", lambda *_: 100.0)
    monkeypatch.setattr(stepwise, "rank_pairs", lambda *_: asked.append(1) or [])
    found = search_effects(Task(None, candidate(0.0), [], {}, None, [one], [], None), 5.0)
    assert (found.best, found.rejected) == (one, [pair])
    assert len(asked) == sought


def test_nothing_is_sought_behind_a_base_model_that_leaves_noise(monkeypatch):
    monkeypatch.setattr(hidden, "compute_excess", lambda *_: (0.0, 0.4))
    monkeypatch.setattr(hidden, "rank_pairs", None)
    columns = SimpleNamespace(blocks=[1], label=["gravity"])
    assert hidden.seek_hidden(None, None, columns, 5.0, None) == []


def test_triples_are_tried_where_no_pair_brings_enough_and_must_bring_more(monkeypatch):
    def offer(nats):
        one = SimpleNamespace(fit=1, log_evidence=nats, model=None)
        return lambda *_: [one]

    base = SimpleNamespace(log_evidence=0.0)
    columns = SimpleNamespace(blocks=[1], label=["gravity", "inertia", "camera_delay"])
    monkeypatch.setattr(hidden, "compute_excess", lambda *_: (3.0, 0.0))
    monkeypatch.setattr(hidden, "rank_pairs", offer(4.0))
    for nats, count in ((6.0, 0), (6.2, 1)):  # 5 and log 3
        monkeypatch.setattr(hidden, "rank_triples", offer(nats))
        assert len(hidden.seek_hidden(None, base, columns, 5.0, None)) == count
