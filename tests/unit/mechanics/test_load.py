import numpy as np
import pytest

from softfinger.faults import Fault
from softfinger.mechanics.load import (
    check_load,
    drop_idle_knots,
    evaluate_load_array,
    integrate_load_array,
)

KNOTS = np.array([1.0, 1.0, 3.0, 4.0, 4.0])
TORQUES = np.array([0.0, 2.0, 4.0, 4.0, -1.0])


def test_value_is_zero_before_then_linear_then_held():
    time = np.array([0.5, 1.0, 2.0, 3.5, 4.0, 9.0])
    assert evaluate_load_array(time, KNOTS, TORQUES).tolist() == [0.0, 2.0, 3.0, 4.0, -1.0, -1.0]


def test_integral_by_hand():
    time = np.array([0.5, 1.0, 2.0, 3.0, 4.0, 6.0, np.nan])
    integral = integrate_load_array(time, KNOTS, TORQUES)
    assert integral[:-1].tolist() == [0.0, 0.0, 2.5, 6.0, 10.0, 8.0]
    assert np.isnan(integral[-1])


def test_padding_by_the_last_knot_changes_nothing():
    time = np.linspace(0.0, 7.0, 29)
    padded = np.r_[KNOTS, [KNOTS[-1]] * 3], np.r_[TORQUES, [TORQUES[-1]] * 3]
    assert (integrate_load_array(time, *padded) == integrate_load_array(time, KNOTS, TORQUES)).all()


def test_a_load_without_idle_knots_is_the_same_function_of_time():
    dense = np.arange(0.0, 6.0, 0.25)
    steps = np.where(dense < 2.0, 0.0, np.where(dense < 4.0, 3.0, 1.0))
    ramp = np.clip(dense - 1.0, 0.0, 3.0)
    before = np.stack([dense, dense]), np.stack([steps, ramp])
    after = drop_idle_knots(*before)
    assert after[0].shape == (2, 6)  # of the steps; the ramp is padded by its last knot
    assert np.unique(after[0][0]).tolist() == [0.0, 1.75, 2.0, 3.75, 4.0, 5.75]
    time = np.linspace(-1.0, 8.0, 91)
    for trial in range(2):
        same = [
            evaluate_load_array(time, *(rows[trial] for rows in some)) for some in (before, after)
        ]
        np.testing.assert_allclose(*same, atol=1e-14)


def test_one_knot_and_a_jump_stay():
    for time, load in (
        ([0.0], [2.0]),
        ([0.0, 0.0], [0.0, 2.0]),
        ([0.0, 1.0, 1.0], [0.0, 0.0, 2.0]),
    ):
        kept = drop_idle_knots(np.array([time]), np.array([load]))
        assert [rows[0].tolist() for rows in kept] == [time, load]


@pytest.mark.parametrize(
    ("load_time", "load_torque", "sentence"),
    [
        ([0.0, 2.0, 1.0], [1.0, 1.0, 1.0], r"load_time\[2\] = 1 s runs backwards.*2 s"),
        ([0.0, 1.0], [1.0, np.nan], r"load_torque\[1\] = nan: it must be finite \[N m\]"),
        ([0.0, np.inf], [1.0, 1.0], r"load_time\[1\] = inf: it must be finite \[s\]"),
        ([0.0, 1.0], [1.0], "same number of knots"),
        ([], [], "at least one"),
    ],
)
def test_impossible_loads_are_refused_with_value_and_bound(load_time, load_torque, sentence):
    with pytest.raises(Fault, match=sentence):
        check_load(load_time, load_torque)
