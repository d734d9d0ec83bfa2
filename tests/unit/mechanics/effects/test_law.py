"""Free laws: curves, their bands, and what a model file holds of them."""

from dataclasses import replace

import numpy as np
import pytest

from softfinger.faults import Fault, ListedFault
from softfinger.mechanics.effects import list_effects
from softfinger.mechanics.effects.effect import FREE, Setting
from softfinger.mechanics.effects.law import ALIKE, EACH, Law, build_curves, free_form
from softfinger.mechanics.effects.law_curve import compute_law_curves, list_laws
from softfinger.mechanics.effects.model import EffectModel, Piece
from softfinger.mechanics.effects.model_file import (
    ModelFile,
    build_model,
    describe_model,
    read_model_file,
    write_model_file,
)
from softfinger.mechanics.forward.curve import KNOTS, build_weights, draw_curve
from softfinger.mechanics.forward.slot import SLOTS


def build_setting(reach=(0.4, 0.35, 0.3), largest_torque=(0.02, 0.03, 0.04, 0.05)):
    """Four trials of three joints."""
    return Setting(
        trials=4, joints=3, interval=0.05, duration=8.0, torque=0.04, reversals=True, levels=True,
        rests=True,
        load_known=True, tension=True, stiffness=np.array([0.1, 0.12, 0.15]),
        reach=np.array(reach), number=np.arange(4.0), memory=np.zeros((4, 3)),
        largest_torque=np.array(largest_torque), rest_time=np.full(4, np.nan), geometry=True,
        camera=True,
    )  # fmt: skip


def pick(name, *, finer=False):
    """The model of one effect in its free form."""
    setting = build_setting()
    effect = list_effects()[name]
    form = next(form for form in effect.list_forms(setting) if form.name.split("_")[0] == FREE)
    form = form.finer if finer else form
    per = {p.per for p in form.parameters}
    places = {"joint": ((0,), (2,)), "neighbours": ((0, 1), (1, 2))}
    there = next((places[kind] for kind in places if kind in per), ())
    return EffectModel(setting, (Piece(effect, form, there),))


def test_a_curve_is_smooth_and_straight_outside_its_reach():
    law = np.random.default_rng(4).normal(size=KNOTS)
    x = np.linspace(-0.5, 1.5, 2001)
    value = draw_curve(law, x)
    slope = np.diff(value) / np.diff(x)
    outside = (x[1:] < 0.0) | (x[:-1] > 1.0)
    assert np.abs(np.diff(slope)).max() < 0.05 * np.ptp(slope)
    for side in (x[1:] < 0.0, x[:-1] > 1.0):
        np.testing.assert_allclose(slope[side], slope[side][0], rtol=1e-8)
    assert outside.any()


def test_a_finer_law_follows_waves_that_the_first_cannot():
    """Each at its most probable, with noise of a tenth of the waves."""
    x = np.linspace(0.0, 1.0, 200)
    waves = 0.2 * np.sin(6.0 * x) ** 2
    rough = free_form(Law("arm_law", "joint_angle_rad", 1.0, 0.5), {})
    missed = []
    for form in (rough, rough.finer):
        curves = build_curves(form.law.terms, x) * [p.sd for p in form.parameters]
        normal = curves.T @ curves + 0.02**2 * np.eye(form.law.terms)
        missed.append(np.std(curves @ np.linalg.solve(normal, curves.T @ waves) - waves))
    assert missed[1] < 0.2 * missed[0]
    assert [p.name for p in rough.finer.parameters][:7] == [p.name for p in rough.parameters]


def test_weights_are_those_of_any_other_spline():
    x = np.array([0.0, 0.031, 0.5, 0.77, 1.0])
    np.testing.assert_allclose(build_weights(x).sum(axis=1), 1.0, rtol=1e-14)
    places = (np.arange(KNOTS) - 1.0) / (KNOTS - 3)  # a spline returns straight lines
    np.testing.assert_allclose(build_weights(x) @ places, x, atol=1e-14)


def test_terms_vanish_at_zero_and_follow_chebyshev():
    x = np.linspace(0.0, 1.0, 50)
    curves = build_curves(4, x)
    np.testing.assert_allclose(curves[0], 0.0, atol=1e-14)
    expected = np.cos(2 * np.arccos(2 * x - 1)) - 1.0
    np.testing.assert_allclose(curves[:, 1], expected, atol=1e-4)


@pytest.mark.parametrize(
    ("name", "own", "alike", "slot"),
    [
        ("strain_stiffening", FREE, ALIKE, "spring_law"),
        ("thinning_damper", FREE, ALIKE, "damper_law"),
        ("fatigue_softening", FREE, ALIKE, "log_k_v"),
        ("moment_arm", EACH, FREE, "arm_law"),
    ],
)
def test_one_law_for_all_joints_is_a_form_beside_one_for_each(name, own, alike, slot):
    setting, effect = build_setting(), list_effects()[name]
    own, alike = (
        next(f for f in effect.list_forms(setting) if f.name.startswith(start))
        for start in (own, alike)
    )
    every = EffectModel(setting, (Piece(effect, own, ((0,), (1,), (2,))),))
    model = EffectModel(setting, (Piece(effect, alike, ()),))
    assert 3 * len(model.entries) == len(every.entries)
    shared = np.random.default_rng(3).normal(size=len(model.entries))
    slots = model.fill_slots(shared).pick(SLOTS[slot])
    same = every.fill_slots(np.repeat(shared, 3)).pick(SLOTS[slot])
    np.testing.assert_allclose(slots, same, rtol=1e-9, atol=1e-9)
    assert np.ptp(slots) > 0.0


def test_one_joint_has_no_law_for_all_joints():
    one = replace(build_setting(reach=(0.4,)), joints=1)
    forms = [form.name for form in list_effects()["strain_stiffening"].list_forms(one)]
    assert FREE in forms
    assert ALIKE not in forms


def test_a_plug_in_gets_a_free_law_with_one_line():
    law = Law("arm_law", "joint_angle_rad", 1.5, 0.5, terms=3)
    form = free_form(law, {"arm_reach": 1.5})
    assert form.is_free
    assert form.law is law
    filled = form.slots({f"arm_law_{k}": np.array(0.1) for k in (1, 2, 3)})
    assert filled["arm_law"].shape == (KNOTS,)
    np.testing.assert_allclose(law.show(law.hide(np.array([0.5, 2.0]))), [0.5, 2.0])


@pytest.mark.parametrize(
    ("change", "sentence"),
    [
        ({"reach": 0.0}, "'arm_law' of 'joint_angle_rad': its reach is 0.0; expected positive"),
        ({"reach": np.array([0.4, np.nan])}, "its reach is .*; expected positive"),
        ({"size": np.inf}, "its size is inf; expected a positive number"),
        ({"terms": 40}, "its terms is 40; expected 1 to 12"),
    ],
)
def test_a_law_that_is_no_smooth_curve_is_refused(change, sentence):
    content = {"name": "arm_law", "argument": "joint_angle_rad", "reach": 1.5, "size": 0.5}
    with pytest.raises(Fault, match=sentence):
        Law(**{**content, **change})


LAWS = {
    "moment_arm": 1, "strain_stiffening": 2, "stress_nonlinear_flow": 1, "joint_coupling": 2,
    "joint_play": 2, "yield_threshold": 1, "lens_distortion": 1,
}  # fmt: skip


@pytest.mark.parametrize("name", LAWS)
def test_a_curve_has_the_band_of_its_terms(name):
    model = pick(name)
    rng = np.random.default_rng(7)
    p = len(model.entries)
    root = 0.02 * rng.normal(size=(p, p))
    mean = 0.1 * rng.normal(size=p)
    curves = compute_law_curves(model, mean, root @ root.T, places=6)
    draws = mean + rng.normal(size=(40_000, p)) @ root.T
    for number, one in enumerate(list_laws(model)):
        x = curves["argument"][number].to_numpy() / one.law.get_reach(one.place)
        shown = one.law.show(draws[:, one.terms] @ build_curves(one.law.terms, x).T)
        low, high = np.quantile(shown, (0.05, 0.95), axis=0)
        np.testing.assert_allclose(curves["low"][number], low, atol=0.01 * np.ptp(shown))
        np.testing.assert_allclose(curves["high"][number], high, atol=0.01 * np.ptp(shown))
    assert curves.sizes["law"] == LAWS[name]


def test_a_model_without_laws_has_no_curves():
    curves = compute_law_curves(EffectModel(build_setting()), np.zeros(0), np.zeros((0, 0)))
    assert curves.sizes["law"] == 0


@pytest.mark.parametrize(
    ("name", "finer"), [*((name, False) for name in [*LAWS][:4]), ("moment_arm", True)]
)
def test_a_law_returns_from_its_file_and_keeps_its_argument(name, finer, tmp_path):
    model = pick(name, finer=finer)
    rng = np.random.default_rng(3)
    mean = 0.3 * model.shared_prior[1] * rng.normal(size=len(model.entries))
    content = describe_model(model, mean, 1e-6 * np.eye(len(mean)), None)
    write_model_file(content, tmp_path / "model.yaml")
    again = read_model_file(tmp_path / "model.yaml")
    assert again.model_dump() == content.model_dump()
    found = build_model(again, model.setting)
    accuracy = 2e-4 if finer else 1e-5  # of so many terms from the file's points
    np.testing.assert_allclose(found.shared_prior[0], mean, atol=accuracy)
    # a campaign of smaller angles and loads has the same law of the same argument
    small = build_setting(
        reach=0.5 * model.setting.reach, largest_torque=0.5 * model.setting.largest_torque
    )
    other = build_model(again, small)
    zero = np.zeros((len(mean), len(mean)))
    before = compute_law_curves(model, mean, zero, places=21)
    after = compute_law_curves(other, other.shared_prior[0], zero, places=11)
    np.testing.assert_allclose(after["argument"], before["argument"][:, :11], rtol=1e-9)
    np.testing.assert_allclose(after["value"], before["value"][:, :11], atol=0.02)


@pytest.mark.parametrize(
    ("law", "sentence"),
    [
        ({"argument": "torque_nm", "at": [0.0, 1.0], "value": [1.0, 1.2]}, "expected 'joint_angle"),
        ({"argument": "joint_angle_rad", "at": [0.0, 1.0], "value": [1.0]}, "as many numbers"),
        ({"argument": "joint_angle_rad", "at": [0.5, 0.1], "value": [1.0, 1.0]}, "must rise"),
    ],
)
def test_a_law_that_does_not_fit_is_refused(law, sentence, tmp_path):
    text = {
        "version": 1, "joint": "three_element", "torque": "constant_arm", "fitted_to": None,
        "effects": [{"id": "moment_arm", "form": "free", "law": law}],
    }  # fmt: skip
    (tmp_path / "model.yaml").write_text(str(text).replace("None", "null"))
    with pytest.raises(ListedFault, match=sentence):
        build_model(read_model_file(tmp_path / "model.yaml"), build_setting())


def test_a_law_where_none_is_is_refused():
    law = {"argument": "torque_nm", "at": [0.0, 1.0], "value": [1.0, 1.2]}
    content = ModelFile.model_validate(
        {
            "version": 1,
            "joint": "three_element",
            "torque": "constant_arm",
            "effects": [{"id": "moment_arm", "form": "paper_geometry", "law": law}],
        }
    )
    with pytest.raises(ListedFault, match="this form has 0"):
        build_model(content, build_setting())
