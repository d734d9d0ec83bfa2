"""What the best model leaves, and what that says of the effects in it."""

import numpy as np
import pytest

from softfinger.mismatch import diagnose
from softfinger.mismatch.findings import weigh_against_shape

CONFIG = {
    "bootstrap_replicates": 99,
    "false_alarm_probability": 0.01,
    "sample_repaired": False,
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
    assert wavy.search.best is not wavy.search.base
    assert max(wavy.posterior.inclusion.values()) > 0.9
    assert weigh_against_shape(wavy.problem, wavy.search, wavy.findings) < 0.5
    assert wavy.verdict.effects == []


def test_an_effect_that_is_there_says_more_than_a_shape(named):
    assert weigh_against_shape(named.problem, named.search, named.findings) > 0.99
