import numpy as np
import pytest

from softfinger.rig.profiles import Steps
from softfinger.rig.proposals import (
    describe_profiles,
    measure_reach,
    propose_profiles,
    stack_knots,
)


def test_proposals_keep_within_tension_and_length():
    for profiles in propose_profiles(6.0, 24.0).values():
        peak, duration = measure_reach(profiles)
        assert peak == pytest.approx(6.0)
        assert duration == pytest.approx(24.0)


def test_profiles_of_different_length_are_stacked_by_their_last_knot():
    long = Steps(name="long", shape="steps", levels_n=[1.0, 2.0, 3.0], hold_s=2.0)
    short = Steps(name="short", shape="steps", levels_n=[5.0], hold_s=1.0)
    time, tension = stack_knots([long, short])
    assert time.shape == tension.shape == (2, 6)
    np.testing.assert_array_equal(time[1], [0.0, 1.0, 1.0, 1.0, 1.0, 1.0])
    np.testing.assert_array_equal(tension[1], 5.0)


def test_a_proposal_can_be_read_back_as_profiles():
    for profiles in propose_profiles(6.0, 24.0).values():
        for profile, written in zip(profiles, describe_profiles(profiles), strict=True):
            again = type(profile).model_validate(written)
            np.testing.assert_array_equal(again.build_knots(), profile.build_knots())
