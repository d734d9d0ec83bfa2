"""What the oracle itself could name."""

import json

import pytest

from softfinger.concealed import limit
from softfinger.concealed.effects import Dose
from softfinger.concealed.limit import compute_limit, list_doses, read_spec, weigh_stand_ins
from softfinger.concealed.registry import EFFECTS
from softfinger.concealed.setting import draw_setting
from softfinger.concealed.strength import expect_effect_gain
from softfinger.concealed.suite import CaseSpec, draw_suite


def _conceal(name, strength):
    spec = CaseSpec(5, (name,), ((),), (0.5,), "staircase", 2, "ar_0.3")
    gain = expect_effect_gain(name, strength, draw_setting(spec))
    effect = {"id": name, "listed": True, "strength": strength, "gain_nats": gain}
    return {"case": json.loads(json.dumps(spec.to_json())), "effects": [effect], "gain_nats": gain}


@pytest.fixture
def few(monkeypatch):
    """A catalogue of four, so that a test ends soon."""
    names = ("camera_delay", "actuator_lag", "strain_stiffening", "moment_arm")
    monkeypatch.setitem(limit.CATALOGUES, "first", names)


@pytest.mark.slow
def test_a_short_delay_is_visible_but_a_lag_does_the_same(few):
    truth = _conceal("camera_delay", 0.004)
    weighed = weigh_stand_ins(truth)
    assert truth["gain_nats"] > 100.0
    assert abs(weighed["camera_delay"]["actuator_lag"]) < 3.0
    assert weighed["camera_delay"]["strain_stiffening"] > 50.0
    assert compute_limit(truth, weighed) < 0.95


@pytest.mark.slow
def test_a_long_delay_has_a_name(few):
    truth = _conceal("camera_delay", 0.1)
    weighed = weigh_stand_ins(truth)
    assert min(weighed["camera_delay"].values()) > 15.0
    assert compute_limit(truth, weighed) > 0.99


def test_what_is_not_visible_is_not_weighed():
    truth = _conceal("camera_delay", 0.004)
    truth["effects"][0]["gain_nats"] = 14.9
    assert weigh_stand_ins(truth) == {}


def test_without_stand_ins_the_base_model_is_the_rival():
    effect = {"id": "gravity", "gain_nats": 0.0}
    assert compute_limit({"case": {}, "gain_nats": 0.0, "effects": [effect]}, {}) < 0.1
    assert compute_limit({"case": {}, "gain_nats": 30.0, "effects": [effect]}, {}) > 0.99


def test_an_effect_is_tried_wherever_it_may_act():
    one = Dose(0.1, {}, (1,))
    assert {d.joints for d in list_doses(EFFECTS["contact_stop"], one, 3)} == {(0,), (1,), (2,)}
    assert {d.joints for d in list_doses(EFFECTS["joint_coupling"], one, 3)} == {(0, 1), (1, 2)}
    assert {d.joints for d in list_doses(EFFECTS["temperature"], one, 3)} == {(1,)}
    chain = Dose(0.1)
    assert {d.joints for d in list_doses(EFFECTS["temperature"], chain, 3)} == {(0, 1, 2)}
    tilted = list_doses(EFFECTS["gravity"], one, 3)
    assert {d.shape["along_base"] for d in tilted} == {0.0, 1.0}


def test_a_case_comes_back_from_its_file():
    for spec in draw_suite(3, 12):
        assert read_spec(json.loads(json.dumps(spec.to_json()))) == spec
