import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from softfinger.campaign import check_campaign, read_campaign, read_load
from softfinger.campaign.load_log import build_load_array


def test_a_tension_becomes_a_torque_through_the_wire_offset(folder):
    campaign = read_campaign(folder)
    time, torque, kind = read_load(campaign, campaign.trials[0], 0.1, 0.0)
    np.testing.assert_allclose(time, [0.0, 0.1, 0.1, 2.0, 2.5])
    np.testing.assert_allclose(torque, [0.0, 0.0, 0.04, 0.04, 0.02])
    assert kind == "tension_n"


def test_rows_further_apart_than_a_step_are_a_ramp(folder):
    campaign = read_campaign(folder)
    time, torque, _ = read_load(campaign, campaign.trials[0], 0.06, 0.0)
    np.testing.assert_allclose(time, [0.0, 0.1, 2.0, 2.5])
    np.testing.assert_allclose(torque, [0.0, 0.04, 0.04, 0.02])


def test_without_a_log_a_unit_command_acts_from_the_first_frame(folder, damage):
    damage("trials.csv", ",load/first.csv,", ",,")
    campaign = read_campaign(folder)
    time, torque, kind = read_load(campaign, campaign.trials[2], 0.1, 0.7)
    assert (time.tolist(), torque.tolist(), kind) == ([0.7, 0.7], [0.0, 1.0], "assumed")


def test_a_first_row_with_load_is_a_step():
    time, load = build_load_array(np.array([1.0, 3.0]), np.array([5.0, 5.0]), 0.1)
    assert (time.tolist(), load.tolist()) == ([1.0, 1.0, 3.0], [0.0, 5.0, 5.0])


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("0.1,8", "0.1,-8", "is -8 N"),
        ("0.1,8", "0.1,8e6", "is 8e+06 N"),
        ("0.1,8", "0.1,nan", "row 3, column 'tension_n'"),
        ("2.0,8", "0.05,8", "time runs backwards"),
        ("tension_n", "newton", "none is there"),
    ],
)
def test_a_wrong_log_sets_its_trials_aside(folder, damage, old, new, said):
    damage("load/first.csv", old, new)
    reasons = check_campaign(folder)
    assert set(reasons) == {"first", "second", "third"}
    assert said in reasons["first"]


def test_a_load_cell_may_scatter_about_zero(folder, damage):
    """Every cell at rest reads a little less than nothing half of the time."""
    damage("load/first.csv", "0.0,0\n", "0.0,-0.02\n")
    assert check_campaign(folder) == {}


def test_a_tension_without_a_wire_offset_is_refused(folder, damage):
    damage("campaign.yaml", "  wire_offset_m: 0.005\n", "")
    assert "needs finger.wire_offset_m" in check_campaign(folder)["first"]


@settings(deadline=None)
@given(
    rows=st.lists(st.tuples(st.floats(0.0, 2.0), st.floats(-5.0, 5.0)), min_size=1, max_size=12),
    step_within=st.floats(0.0, 1.0),
)
def test_every_load_is_a_function_of_time_that_passes_through_its_rows(rows, step_within):
    time = np.cumsum([gap for gap, _ in rows])
    value = np.array([v for _, v in rows])
    knots, load = build_load_array(time, value, step_within)
    assert (np.diff(knots) >= 0).all()
    assert load[-1] == value[-1]
    for t, v in zip(time, value, strict=True):
        assert v in load[knots == t] or v == np.interp(t, knots, load)
