"""Parameters of effects that differ between trials, drawn."""

import numpy as np
from tests.unit.mechanics.test_model_file import SETTING

from softfinger.mechanics.effects import list_effects
from softfinger.mechanics.effects.model import EffectModel, Piece
from softfinger.mechanics.effects.spread import list_varying, vary_effects


def build(effect, form, places):
    found = list_effects()[effect]
    chosen = next(f for f in found.list_forms(SETTING) if f.name == form)
    return EffectModel(SETTING, (Piece(found, chosen, places),))


def test_each_number_varies_by_its_own_share_and_within_its_bounds():
    model = build("second_retardation", "own_compliance", ((1,), (2,)))
    assert list_varying(model.pieces[0], model) == ["compliance_share", "retardation_time_s"]
    sizes = {
        "second_retardation:compliance_share": 0.1,
        "second_retardation:retardation_time_s": 0.2,
    }
    middle = np.tile([0.4, 0.8, np.log(5.0)], (4000, 1))
    drawn = vary_effects(model, middle, sizes, np.random.default_rng(3))
    np.testing.assert_allclose(drawn.std(axis=0), [0.04, 0.08, 0.2], rtol=0.05)
    np.testing.assert_allclose(drawn.mean(axis=0), middle[0], atol=0.01)
    assert abs(np.corrcoef(drawn[:, :2].T)[0, 1]) < 0.05
    wide = dict.fromkeys(sizes, 5.0)
    drawn = vary_effects(model, middle, wide, np.random.default_rng(3))
    assert (drawn >= model.low).all()
    assert (drawn <= model.high).all()


def test_what_has_no_spread_draws_nothing():
    model = build("second_retardation", "own_compliance", ((1,),))
    rng = np.random.default_rng(3)
    middle = np.ones((2, 2))
    np.testing.assert_array_equal(vary_effects(model, middle, {}, rng), middle)
    assert rng.normal() == np.random.default_rng(3).normal()


def test_all_terms_of_a_law_vary_together():
    model = build("contact_stop", "free", ((0,),))
    terms = np.flatnonzero(model.terms)
    assert len(terms) > 2
    law = next(n for n in list_varying(model.pieces[0], model) if n.endswith("law"))
    middle = np.ones((50, len(model.entries)))
    drawn = vary_effects(model, middle, {f"contact_stop:{law}": 0.1}, np.random.default_rng(3))
    share = drawn[:, terms]
    np.testing.assert_allclose(share, np.tile(share[:, :1], len(terms)))
