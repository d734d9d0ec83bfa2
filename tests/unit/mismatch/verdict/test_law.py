"""What a verdict says of a free law."""

import numpy as np
import pytest

from softfinger.inference.problem import Candidate
from softfinger.mechanics.effects import list_effects
from softfinger.mechanics.effects.effect import Parameter, Setting
from softfinger.mechanics.effects.model import EffectModel, Entry, Piece
from softfinger.mismatch.verdict.estimates import estimate_entry
from softfinger.mismatch.verdict.law import state_law

SETTING = Setting(
    trials=4, joints=2, interval=0.05, duration=8.0, torque=0.04, reversals=True, levels=True,
    rests=True,
    load_known=True, tension=True, stiffness=np.array([0.1, 0.12]), reach=np.array([0.4, 0.9]),
    number=np.arange(4.0), memory=np.zeros((4, 2)), largest_torque=np.full(4, 0.04),
    rest_time=np.full(4, np.nan), geometry=True,
)  # fmt: skip


def build(form, evidence, fit=True, name="moment_arm", places=()):
    effect = list_effects()[name]
    chosen = next(f for f in effect.list_forms(SETTING) if f.name == form)
    model = EffectModel(SETTING, (Piece(effect, chosen, places),))
    return Candidate(model, object() if fit else None, evidence)


def test_a_free_law_is_stated_with_the_textbook_behind_it():
    free, chord = build("free", 100.0), build("paper_geometry", 60.0)
    others = [
        free,
        chord,
        build("paper_geometry", 99.0, fit=False),
        build("gap", 90.0, name="joint_play", places=((0,),)),
    ]
    law = state_law(free, 0, others)
    assert (law.argument, law.form, law.artifact) == ("joint_angle_rad", "free", "laws.nc")
    assert law.range == (0.0, 0.9)
    assert law.forms_nats == {"paper_geometry": pytest.approx(-40.0)}


def test_a_textbook_form_has_no_law_of_its_own():
    assert state_law(build("paper_geometry", 60.0), 0, []) is None


def test_terms_of_a_law_are_no_parameters_of_a_verdict():
    assert estimate_entry(Entry(0, Parameter("arm_law_1", term=True), ()), 0.1, 0.01) == {}
