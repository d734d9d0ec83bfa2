"""Curves of laws against their bands, on artifacts written by hand."""

from types import SimpleNamespace

import numpy as np
import pytest
import xarray as xr

from softfinger.concealed.law_bands import collect_laws, measure_coverage
from softfinger.concealed.registry import EFFECTS


def _curves(effect, argument, value, x, joint=0, kind="factor", width=0.01):
    return xr.Dataset(
        {
            "argument": (("law", "place"), x[None]),
            "value": (("law", "place"), value[None]),
            "low": (("law", "place"), value[None] - width),
            "high": (("law", "place"), value[None] + width),
            "effect": ("law", [effect]),
            "argument_name": ("law", [argument]),
            "kind": ("law", [kind]),
            "joint": ("law", [joint]),
        }
    )


def _truth(name, strength, joints=(), **more):
    law = EFFECTS[name]
    effect = {"id": law.id, "name": name, "strength": strength, "joints": list(joints)}
    effect |= {"argument": law.argument, "law": law.law, "scatter": 0.0} | more
    return {"case": {"trials": 20}, "effects": [effect]}


X = np.linspace(0.0, 0.8, 41)
ARM = 1.0 + 1.5 * X**2


def test_a_curve_in_its_band_is_covered_and_one_outside_is_not():
    truth = _truth("moment_arm/guides", 1.5)
    inside = _curves("moment_arm", "joint_angle_rad", ARM, X)
    assert measure_coverage(inside, truth) == [1.0]
    off = _curves("moment_arm", "joint_angle_rad", ARM + 0.02 * (X > 0.4), X)
    assert measure_coverage(off, truth) == [pytest.approx(0.5)]


@pytest.mark.parametrize(
    ("truth", "curves"),
    [
        (_truth("moment_arm/guides", 1.5), _curves("gravity", "joint_angle_rad", ARM, X)),
        (_truth("moment_arm/guides", 1.5), _curves("moment_arm", "bend_rad", ARM, X)),
        (
            _truth("moment_arm/guides", 1.5, scatter=0.2),
            _curves("moment_arm", "joint_angle_rad", ARM, X),
        ),
        (
            _truth("strain_stiffening/plateau", 0.5, joints=[2]),
            _curves("strain_stiffening", "elastic_angle_rad", ARM, X, joint=1),
        ),
        (_truth("wire_friction/edge", 0.1), _curves("wire_friction", "bend_rad", ARM, X)),
    ],
)
def test_what_is_not_the_same_curve_is_not_compared(truth, curves):
    assert measure_coverage(curves, truth) == []


def test_a_drift_is_a_curve_of_the_trials_number():
    number = np.arange(20.0)
    law = EFFECTS["load_gain/warm_up"]
    gain = 1.0 + 0.1 * law.curve(number, 20)
    assert gain[0] == 1.0
    assert gain[-1] == pytest.approx(1.1, abs=0.001)
    curves = _curves("load_gain", "trial_number", gain, number, kind="exponential")
    assert measure_coverage(curves, _truth("load_gain/warm_up", 0.1)) == [1.0]


@pytest.mark.parametrize(
    "name", [name for name, effect in EFFECTS.items() if effect.curve is not None]
)
def test_a_curve_begins_at_nothing(name):
    assert EFFECTS[name].curve(np.zeros(1), 20)[0] == pytest.approx(0.0, abs=2e-3)


def test_laws_are_counted_alone_and_in_pairs():
    def case(right, confident=True, visible=True):
        return SimpleNamespace(right=right, confident=confident, visible=visible, contains=right)

    strange, known = {"law": "guides"}, {"law": ""}
    judged = [
        ({"effects": [strange]}, case(True)),
        ({"effects": [strange]}, case(False)),
        ({"effects": [strange]}, case(False, visible=False)),
        ({"effects": [strange, strange]}, case(False, confident=False)),
        ({"effects": [strange, known]}, case(True)),
        ({"effects": []}, case(True)),
    ]
    found = collect_laws(judged, [0.9, 0.8])
    assert found["law_named_share_single"] == 0.5
    assert found["law_named_share_pair"] == 0.0
    assert found["law_false_set_share"] == pytest.approx(1 / 3)
    assert found["law_band_coverage_90"] == pytest.approx(0.85)
    assert collect_laws([], []) == {}
