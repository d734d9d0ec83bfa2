import numpy as np
import pytest

from softfinger.faults import Fault
from softfinger.mechanics.effects import list_effects
from softfinger.mechanics.effects.demonstration import LARGEST_NM, demonstrate_effect
from softfinger.mechanics.effects.effect import Effect

EFFECTS = list_effects().values()


@pytest.mark.parametrize("effect", EFFECTS, ids=lambda effect: effect.id)
def test_an_effect_moves_the_finger_where_it_says_that_it_shows(effect):
    shown = demonstrate_effect(effect)
    without, moved = shown["joint_angle"].to_numpy()
    assert np.abs(moved - without).max() > 0.02 * without.max()
    assert np.ptp(without, axis=0).max() == 0.0  # the trials are alike
    assert (np.ptp(moved, axis=0).max() > 1e-3) == (effect.level == "between_trials")
    assert shown["load"].max() == LARGEST_NM


def test_the_stop_keeps_the_joint_from_going_on():
    shown = demonstrate_effect(list_effects()["contact_stop"]).sel(trial=1)
    without, moved = shown["joint_angle"].to_numpy()
    np.testing.assert_allclose(moved[:, 320:], without[:, 320:], atol=0.01)
    assert (moved.max(axis=-1) < 0.9 * without.max(axis=-1)).all()


def test_an_effect_without_a_form_cannot_be_shown():
    dumb = Effect("dumb", "nothing happens", "within_trial", lambda _: "there is nothing to see")
    with pytest.raises(Fault, match="'dumb' cannot be shown: there is nothing to see"):
        demonstrate_effect(dumb)
