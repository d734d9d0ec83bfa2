"""Finer laws of the parts of a set."""

from types import SimpleNamespace

import pytest

from softfinger.mechanics.effects import list_effects
from softfinger.mechanics.effects.model import Piece
from softfinger.mismatch.candidates.other_forms import list_finer
from softfinger.mismatch.candidates.rank import list_pieces
from softfinger.mismatch.search import finer


def fitted(nats, *ids):
    return SimpleNamespace(model=SimpleNamespace(ids=set(ids)), fit=1, log_evidence=nats)


def test_the_best_of_each_part_is_tried_with_finer_laws(monkeypatch):
    arm, worse = fitted(80.0, "moment_arm"), fitted(60.0, "moment_arm")
    stop, lens = fitted(50.0, "contact_stop"), fitted(90.0, "lens_distortion")
    unfitted = fitted(99.0, "moment_arm")
    unfitted.fit = None
    for one in (arm, worse, stop, lens, unfitted):
        one.model.ids = frozenset(one.model.ids)
    top = fitted(110.0)
    top.model.ids = frozenset({"moment_arm", "contact_stop"})
    monkeypatch.setattr(finer, "list_finer", lambda part, _: part)
    monkeypatch.setattr(finer, "swap_forms", lambda _, part, *__: [(part, "finer")])
    found = finer.fit_finer(None, top, [arm, worse, stop, lens, unfitted], [])
    assert sorted(part.log_evidence for part, _ in found) == [50.0, 80.0]


def test_rivals_that_come_near_are_tried_with_finer_laws(monkeypatch):
    """Two gaps looked like a damper that thins, which beat the one gap by a third."""
    best, other_form = fitted(900.0, "thinning_damper"), fitted(850.0, "thinning_damper")
    play, worse = fitted(600.0, "joint_play"), fitted(590.0, "joint_play")
    far, pair = fitted(300.0, "wire_friction"), fitted(950.0, "joint_play", "wire_friction")
    found = [play, best, far, worse, pair, other_form]
    for one in found:
        one.model.ids = frozenset(one.model.ids)
    monkeypatch.setattr(finer, "list_finer", lambda part, _: part)
    monkeypatch.setattr(finer, "swap_forms", lambda _, part, *__: [(part, "finer")])
    assert finer.fit_rivals_finer(None, fitted(0.0), best, found, []) == [(play, "finer")]


@pytest.mark.parametrize("form", ["square_in_elastic_angle", "free"])
def test_a_law_is_finer_where_the_effect_acts_whatever_form_leads(clean, form):
    setting = clean.problem.setting
    effect = list_effects()["strain_stiffening"]
    chosen = next(one for one in effect.list_forms(setting) if one.name == form)
    model = clean.problem.base.extend(Piece(effect, chosen, ((0,),)))
    candidate = clean.search.base._replace(model=model)
    (found,) = list_finer(candidate, list_pieces(setting)[0])
    assert (found.effect.id, found.form.name) == ("strain_stiffening", "free_finer")
    assert found.places == ((0,),)
