"""What the best model leaves, and what that says of the effects in it."""

import numpy as np
import pytest

from softfinger.mismatch import diagnose
from softfinger.mismatch.checks.findings import weigh_against_shape

CONFIG = {
    "bootstrap_replicates": 99,
    "false_alarm_probability": 0.01,
    "sample_repaired": False,
    "longest_search_s": 600.0,
}


@pytest.fixture(scope="module")
def wavy(draw_campaign):
    """Diagnose a campaign whose camera swings: a wave in time that no effect of the list makes."""
    angles = draw_campaign(2, 0.0)
    swing = 0.006 * np.sin(2 * np.pi * angles["time"] / 7.0)
    moved = angles.assign(
        joint_angle=(angles["joint_angle"] + swing).transpose("trial", "joint", "frame")
    )
    return diagnose(moved, CONFIG, 5, lambda items, _: items)


def test_effects_that_only_take_the_part_of_a_shape_are_not_stated(wavy):
    assert wavy.verdict.decision == "unlisted"
    assert wavy.search.best is wavy.search.base
    assert wavy.verdict.effects == []


def test_an_effect_that_is_not_in_the_list_is_unlisted_and_shown_to_depend_on_the_rate(thinned):
    assert thinned.verdict.decision == "unlisted"
    assert thinned.verdict.effects == []
    assert thinned.verdict.free_form.argument == "rate_rad_per_s"
    shape = thinned.findings.free.shape["value"][0]
    # s ∝ r |r|: an odd curve that rises at both ends, and nothing at rest
    assert thinned.findings.free.joints == [1]
    assert abs(float(shape.interp(place=0.0))) < 1e-3
    assert shape[-1] > 0.001
    assert shape[0] < -0.001


def test_a_damper_that_thins_is_named_where_the_list_has_it(recorded_thinning):
    found = diagnose(recorded_thinning, CONFIG, 5, lambda items, _: items)
    assert found.verdict.decision == "named"
    assert [effect.id for effect in found.verdict.effects] == ["thinning_damper"]


def test_an_effect_that_is_there_says_more_than_a_shape(named):
    assert weigh_against_shape(named.search, named.findings) > 0.99


def test_effects_beyond_the_best_set_are_sought_where_none_is_named(wavy, thinned, named):
    assert named.search.beyond == ()
    for unlisted in (wavy, thinned):
        sets = [c.model.ids for c in unlisted.search.beyond]
        assert [set(one.effects) for one in unlisted.verdict.explained[: len(sets)]] == sets[::-1]
    assert any(found.search.beyond for found in (wavy, thinned))
