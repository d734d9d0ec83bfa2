"""The sentence that states an effect."""

import numpy as np
import pytest
import xarray as xr

from softfinger.artifacts.verdict import Estimate
from softfinger.mechanics.effects import list_effects
from softfinger.mismatch.verdict.statements import state_curves, state_effect
from softfinger.units import Units


@pytest.mark.parametrize(
    ("probability", "words"), [(1.0, "above 0.999"), (0.9996, "above 0.999"), (0.973, "0.973")]
)
def test_no_effect_is_certain(probability, words):
    effect = list_effects()["gravity"]
    assert f"with probability {words}. " in state_effect(effect, "even", [1], probability, {}, {})


@pytest.mark.parametrize(("probability", "first"), [(0.9, "The recording"), (0.05, "Perhaps the")])
def test_what_is_not_likely_is_no_fact(probability, first):
    effect = list_effects()["camera_delay"]
    assert state_effect(effect, "constant", [], probability, {}, {}).startswith(first)


def test_a_parameter_that_differs_between_trials_is_stated():
    effect = next(iter(list_effects().values()))
    words = state_effect(effect, "even", [], 0.9, {}, {"delay_s": 0.143})
    assert words.endswith("From trial to trial the delay differs by 14 %.")


def test_a_free_law_is_stated_where_it_ends():
    shape = ("law", "place")
    laws = xr.Dataset(
        {
            "effect": ("law", np.array(["moment_arm", "softening", "membrane"], object)),
            "argument_name": (
                "law",
                np.array(["angle_rad", "time_in_trial_s", "difference_rad"], object),
            ),
            "kind": ("law", np.array(["factor", "exponential", "sum"], object)),
            "joint": ("law", [0, 2, 1]),
            "argument": (shape, [[0.0, 0.6], [0.0, 20.0], [0.0, 0.25]]),
            "value": (shape, [[1.0, 1.25], [1.0, 0.301], [0.0, -0.012]]),
            "low": (shape, [[1.0, 1.2], [1.0, 0.128], [0.0, -0.02]]),
            "high": (shape, [[1.0, 1.3], [1.0, 0.71], [0.0, 0.001]]),
        }
    )
    assert state_curves(laws, "moment_arm") == (
        " Its free law multiplies by 1.25 (1.2 to 1.3) at angle 0.6 rad."
    )
    assert state_curves(laws, "softening") == (
        " Its free law multiplies by 0.301 (0.128 to 0.71) at time in trial 20 s in joint 2."
    )
    assert state_curves(laws, "membrane") == (
        " Its free law adds -0.012 (-0.02 to 0.001) at difference 0.25 rad in joint 1."
    )
    assert state_curves(laws, "gravity") == ""


def test_an_effect_of_a_specimen_is_stated_in_its_units():
    effect, units = list_effects()["contact_stop"], Units("mm", "N", 20.0, specimen=True)
    size = {"stop_angle_rad_1": Estimate(mean=0.4, sd=0.1, q05=0.2, q95=0.6)}
    words = state_effect(effect, "hard", [1], 0.9, size, {}, units=units)
    assert words.startswith("The specimen meets a stop: contact stop was left out")
    assert "Best form: hard; stop angle 1 8.0 ± 2.0 mm." in words
    shape = ("law", "place")
    laws = xr.Dataset(
        {
            "effect": ("law", ["moment_arm"]),
            "argument_name": ("law", ["angle_rad"]),
            "kind": ("law", ["factor"]),
            "joint": ("law", [1]),
            "argument": (shape, [[0.0, 0.6]]),
            **{name: (shape, [[1.0, 1.25]]) for name in ("value", "low", "high")},
        }
    )
    assert state_curves(laws, "moment_arm", units).endswith("(1.25 to 1.25) at angle 12 mm.")
