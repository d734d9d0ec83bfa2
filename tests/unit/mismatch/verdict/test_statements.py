"""The sentence that states an effect."""

import pytest

from softfinger.mechanics.effects import list_effects
from softfinger.mismatch.verdict.statements import state_effect


@pytest.mark.parametrize(
    ("probability", "words"), [(1.0, "above 0.999"), (0.9996, "above 0.999"), (0.973, "0.973")]
)
def test_no_effect_is_certain(probability, words):
    effect = list_effects()["gravity"]
    assert f"with probability {words}. " in state_effect(effect, "even", [1], probability, {}, {})


def test_a_parameter_that_differs_between_trials_is_stated():
    effect = next(iter(list_effects().values()))
    words = state_effect(effect, "even", [], 0.9, {}, {"delay_s": 0.143})
    assert words.endswith("From trial to trial the delay differs by 14 %.")
