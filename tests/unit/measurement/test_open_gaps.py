import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from softfinger.campaign.load_log import build_load_array
from softfinger.measurement.decisions import DECISIONS
from softfinger.measurement.open_gaps import (
    bridge_gaps_array,
    build_hats_array,
    find_open_gaps_array,
)
from softfinger.measurement.step_time import open_steps_array

INTERVAL = 0.04
ROWS = st.lists(
    st.tuples(st.floats(1e-3, 3.0), st.sampled_from([0.0, 1.0, 2.0])), min_size=2, max_size=12
)


def find(time, load, interval=INTERVAL):
    return find_open_gaps_array(np.array(time, float), np.array(load, float), interval).tolist()


@pytest.mark.parametrize("levels", [1, 2, 5])
def test_hats_have_the_covariance_of_a_step_at_any_moment(levels):
    share = np.linspace(0.0, 1.0, 2**levels + 1)
    hats = build_hats_array(levels)
    bridge = np.minimum.outer(share, share) - np.outer(share, share)
    np.testing.assert_allclose(hats.T @ hats, bridge, atol=1e-12)


@given(ROWS, st.integers(1, 4))
def test_an_opened_log_is_the_same_load_and_its_bridges_end_at_the_rows(rows, levels):
    time = np.cumsum([gap for gap, _ in rows])
    log = build_load_array(time, np.array([value for _, value in rows]), 1.5 * INTERVAL)
    gaps = find_open_gaps_array(*log, INTERVAL)
    opened, load, bridge = bridge_gaps_array(*log, gaps, levels)
    assert (np.diff(opened) >= 0.0).all()
    moments = np.setdiff1d(np.linspace(time[0], time[-1], 50), time)
    np.testing.assert_allclose(
        np.interp(moments, opened, load), np.interp(moments, *log), atol=1e-12
    )
    assert bridge.shape == (len(gaps) * (2**levels - 1), len(opened))
    assert not bridge[:, np.isin(opened, time)].any()


@given(ROWS)
def test_opened_steps_keep_their_order_and_their_rows(rows):
    time = np.cumsum([gap for gap, _ in rows])
    knots, load = build_load_array(time, np.array([value for _, value in rows]), 1.5)
    opened = open_steps_array(knots, load, 1.0)
    assert (np.diff(opened) >= 0.0).all()
    last = np.append(np.diff(knots) > 0.0, True)
    np.testing.assert_array_equal(opened[last], knots[last])


def rest(*load):
    """A log of a row a second that rests for a dozen of them, and then reads these loads."""
    return find(np.arange(12.0 + len(load)), np.append(np.full(12, load[0]), load))


def test_a_log_that_reads_as_seldom_at_rest_has_open_gaps_where_the_load_moves():
    assert rest(0, 5, 5) == [12]
    assert rest(0, 5, 5, 1) == [12, 14]
    assert rest(0, 2, 4, 5, 5) == [12, 13, 14]
    assert rest(2, 2.05, 2) == []  # noise of the log


def test_rows_that_state_a_ramp_or_a_jump_leave_no_gap_open():
    assert find([0, 2, 4, 6, 8], [0, 0, 5, 5, 0]) == []
    assert find([0, 5, 10, 15], [0, 8, 0, 8]) == []
    assert find([*np.arange(0, 3, 0.1), 5, *np.arange(5.1, 8, 0.1)], [0] * 30 + [5] * 31) == []
    assert find([0, 3, 3, 9], [0, 0, 5, 5]) == []
    few = DECISIONS.pace_rows  # gaps at rest, and one less
    assert find(np.arange(few + 2), [*np.zeros(few + 1), 5]) == [few]
    assert find(np.arange(few + 1), [*np.zeros(few), 5]) == []


def test_one_lost_row_is_another_pace():
    time, load = np.arange(20.0), np.append(np.zeros(15), np.full(5, 5.0))
    slightly, doubly = time.copy(), time.copy()
    slightly[15:] += 0.4
    doubly[15:] += 1.0
    assert find(slightly, load) == [14]
    assert find(doubly, load) == []


def test_rows_as_close_as_those_of_a_jump_leave_a_gap_between_levels_open():
    assert find([0, 3, 3.03, 9], [0, 0, 5, 5]) == [1]
    assert find([0, 3, 3, 3.03, 9, 9], [0, 0, 0, 5, 5, 5]) == [2]  # with knots repeated
    assert find([0, 3, 3.03, 3.06, 9], [0, 0, 3, 5, 5]) == []  # a ramp


def test_a_step_that_was_opened_has_an_open_gap():
    log = build_load_array(
        np.array([0.0, 2.96, 3.0, 9.0]), np.array([0.0, 0, 5, 5]), 1.5 * INTERVAL
    )
    assert find(*log) == []
    opened = open_steps_array(*log, INTERVAL)
    (gap,) = find(opened, log[1])
    assert (opened[gap], opened[gap + 1]) == (2.96, 3.0)
