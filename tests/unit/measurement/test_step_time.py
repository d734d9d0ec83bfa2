import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from softfinger.campaign.load_log import STEP_WITHIN_FRAME_INTERVALS, build_load_array
from softfinger.measurement.decisions import DECISIONS
from softfinger.measurement.step_time import (
    advance_steps_array,
    find_step_gaps_array,
    list_steps_array,
    open_steps_array,
    place_steps_array,
)
from softfinger.mechanics.effects import load_limit

ROWS = st.lists(
    st.tuples(st.floats(1e-3, 3.0), st.sampled_from([0.0, 1.0, 2.0])), min_size=1, max_size=12
)


@given(ROWS, st.floats(0.0, 1.0))
def test_knots_stay_in_their_order_wherever_steps_come(rows, share):
    time = np.cumsum([gap for gap, _ in rows])
    knots, load = build_load_array(time, np.array([value for _, value in rows]), 1.5)
    moved = advance_steps_array(knots, load, share, 1.0)
    assert (np.diff(moved) >= 0.0).all()
    assert (moved <= knots).all()
    assert (knots - moved <= 1.5 + 1e-12).all()


@given(ROWS, st.floats(0.0, 1.0))
def test_each_step_placed_at_one_share_is_all_steps_sooner_by_it(rows, share):
    time = np.cumsum([gap for gap, _ in rows])
    load = build_load_array(time, np.array([value for _, value in rows]), 1.5)
    knots, torque = (part[None] for part in load)
    steps = list_steps_array(knots, torque, 1.0)
    assert (steps > 0.0).all()
    placed = place_steps_array(knots, torque, np.full(steps.shape, share), 1.0)
    np.testing.assert_array_equal(placed, advance_steps_array(knots, torque, share, 1.0))


def test_each_step_comes_sooner_by_a_share_of_its_own_gap():
    knots = np.array([[0.0, 1.0, 1.1, 1.1, 2.0, 2.2, 2.2], [0.0, 1.0, 1.0, 1.0, 2.0, 2.4, 2.4]])
    load = np.array([[0.0, 0.0, 0.0, 4.0, 4.0, 4.0, 1.0], [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 3.0]])
    np.testing.assert_allclose(list_steps_array(knots, load, 0.3), [[0.1, 0.2], [0.4, 0.0]])
    moved = place_steps_array(knots, load, np.array([[0.5, 0.25], [1.0, 0.0]]), 0.3)
    np.testing.assert_allclose(
        knots - moved, [[0, 0, 0.05, 0.05, 0, 0.05, 0.05], [0] * 5 + [0.4] * 2]
    )


def test_a_step_that_is_stated_at_once_has_no_gap():
    knots, load = np.array([0.0, 5.0, 5.0, 9.0]), np.array([0.0, 0.0, 1.0, 1.0])
    assert not find_step_gaps_array(knots, load, 0.03).any()
    knots, load = build_load_array(np.array([0.0, 4.98, 5.0]), np.array([0.0, 0.0, 1.0]), 0.045)
    assert find_step_gaps_array(knots, load, 0.03).max() == np.float64(5.0) - 4.98


def test_a_log_that_reads_as_seldom_at_rest_has_wide_gaps():
    time = 0.1 * np.arange(20.0)
    knots, load = np.insert(time, 14, time[14]), np.append(np.zeros(15), np.full(6, 2.0))
    assert find_step_gaps_array(knots, load, 0.03).max() == pytest.approx(0.1)
    fewer = np.append(knots[:1], knots[6:]), np.append(load[:1], load[6:])
    assert not find_step_gaps_array(fewer[0][1:], fewer[1][1:], 0.03).any()


def test_rests_that_end_in_steps_are_no_gaps():
    knots, load = np.repeat(5.0 * np.arange(16.0), 2)[1:-1], np.repeat(np.arange(15.0), 2)
    assert not find_step_gaps_array(knots, load, 0.03).any()


def test_the_gaps_are_those_in_which_the_reader_sees_steps():
    assert DECISIONS.step_rows == STEP_WITHIN_FRAME_INTERVALS == load_limit.SELDOM


@pytest.mark.parametrize("share", [None, 1.0])
def test_rounding_moves_no_step_before_its_row(share):
    """Times that ran backwards let no model be fitted."""
    rng = np.random.default_rng(2)
    time = np.round(rng.uniform(0.0, 0.01, 200)[:, None] + 0.01 * np.arange(20), 6)
    for rows in time:
        knots, load = build_load_array(rows, rng.normal(size=20), 0.06)
        if share is None:
            moved = open_steps_array(knots, load, 0.04)
        else:
            moved = advance_steps_array(knots, load, share, 0.04)
        assert (np.diff(moved) >= 0.0).all()
