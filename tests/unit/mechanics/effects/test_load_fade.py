import numpy as np
import pytest

from softfinger.mechanics.effects.load_fade import _refine


@pytest.mark.parametrize("rise", [0.001, 0.1, 1.0])
def test_a_load_that_sags_is_met_by_straight_lines_however_fast_it_rises(rise):
    """What is lost of a ramp is u |u| t: no straight line between its ends."""
    ends = np.array([0.9 * (1.0 - rise), 0.9 * (1.0 - rise) + rise])
    time, load, _ = _refine(ends, np.array([0.0, 2.0]), np.zeros((2, 0)), 1.0, 2.0)
    moment = np.linspace(*ends, 2000)
    u = 2.0 * (moment - ends[0]) / rise
    straight = np.interp(moment, time, load * np.abs(load) / 2.0 * time)
    np.testing.assert_allclose(straight, u * u / 2.0 * moment, atol=2e-3)  # of 2
    assert time[-1] == 1.0


def test_a_jump_stays_a_jump():
    time, load, _ = _refine(
        np.array([0.0, 0.5, 0.5]), np.array([1.0, 1.0, 3.0]), np.zeros((3, 0)), 1.0, 2.0
    )
    at = np.flatnonzero(time == 0.5)
    np.testing.assert_array_equal(load[at], [1.0, 3.0])
    assert np.all(np.diff(time) >= 0.0)
    assert time[-1] == 1.0
