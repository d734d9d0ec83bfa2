"""A log's changes of load do not depend on how densely it was written."""

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from softfinger.campaign.load_log import build_load_array
from softfinger.measurement.corners import find_corners_array
from softfinger.measurement.quiet import find_load_changes_array
from softfinger.measurement.ramps import straighten_ramps_array

TURNS = np.array([0.0, 0.5, 4.5, 8.5, 12.5, 20.0])
LOADS = np.array([0.0, 0.0, 7.0, 0.0, 7.0, 7.0])


def write_densely(rate, start=0.0):
    time = np.arange(start, TURNS[-1], 1.0 / rate)
    return time, np.interp(time, TURNS, LOADS)


@pytest.mark.parametrize("rate", [10.0, 37.0, 100.0, 1000.0])
@pytest.mark.parametrize("digits", [12, 3])
@pytest.mark.parametrize("times", [1, 2])
def test_a_dense_triangle_changes_where_it_turns(rate, digits, times):
    time, load = (np.repeat(rows, times) for rows in write_densely(rate))
    found = find_load_changes_array(time, load.round(digits))
    sparse = find_load_changes_array(TURNS, LOADS)
    assert sparse.tolist() == [0.5, 4.5, 8.5, 12.5]
    apart = np.abs(found[:, None] - sparse)
    assert max(apart.min(axis=0).max(), apart.min(axis=1).max()) < 1.01 / rate + 0.008


def test_a_smooth_wave_has_no_change_of_load():
    time = np.arange(0.0, 30.0, 0.01)
    load = 3.0 * (1.0 - np.cos(time))
    assert find_load_changes_array(time, load).tolist() in ([], [time[-1]])  # then it rests


@given(
    st.lists(st.floats(-1.0, 1.0), min_size=2, max_size=60),
    st.lists(st.sampled_from([0.0, 0.01, 0.1, 1.0]), min_size=60, max_size=60),
    st.floats(0.0, 0.5),
)
def test_every_knot_is_near_the_straight_pieces(torque, steps, tolerance):
    torque = np.array(torque)
    time = np.cumsum(steps)[: torque.size]
    corners = find_corners_array(time, torque, tolerance)
    assert corners[0] == 0
    assert corners[-1] == torque.size - 1
    assert (np.diff(corners) > 0).all()
    jumps = np.flatnonzero((np.diff(time) == 0.0) & (np.abs(np.diff(torque)) > tolerance))
    assert {*jumps, *jumps + 1} <= {*corners}
    for begin, end in pairwise(corners):
        inside = slice(begin, end + 1)
        if time[end] > time[begin]:
            line = np.interp(time[inside], time[[begin, end]], torque[[begin, end]])
            assert np.abs(torque[inside] - line).max() <= tolerance * (1.0 + 1e-9) + 1e-12


def test_ramps_that_were_read_as_stairs_turn_where_they_did():
    stair = build_load_array(*write_densely(100.0), step_within=0.05)
    found = find_load_changes_array(*straighten_ramps_array(*stair, 0.05))
    assert np.abs(found - [0.5, 4.5, 8.5, 12.5]).max() < 0.02
