import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from softfinger.mechanics.three_element import compute_joint_angle_array

logs = st.floats(-5.0, 5.0)
torques = st.lists(st.floats(-1.0, 1.0), min_size=4, max_size=4)
TIME = np.linspace(-1.0, 20.0, 11)
KNOTS = np.array([0.0, 3.0, 3.0, 9.0])


@settings(deadline=None)
@given(logs, logs, logs, torques, torques)
def test_loads_superpose(k_v, c_v, c_p, first, second):
    parameters = (*np.exp([k_v, c_v, c_p]), 0.0)

    def simulate(torque):
        return compute_joint_angle_array(*parameters, TIME, KNOTS, torque)

    both = simulate(np.add(first, second))
    size = 1.0 + np.abs(simulate(np.abs(first))).max() + np.abs(simulate(np.abs(second))).max()
    assert np.abs(both - simulate(first) - simulate(second)).max() < 1e-12 * size


@settings(deadline=None)
@given(logs, logs, logs, torques, st.floats(0.1, 10.0))
def test_units_of_time_do_not_matter(k_v, c_v, c_p, torque, scale):
    k, c, d = np.exp([k_v, c_v, c_p])
    seconds = compute_joint_angle_array(k, c, d, 0.1, TIME, KNOTS, torque)
    other = compute_joint_angle_array(
        k, c * scale, d * scale, 0.1, TIME * scale, KNOTS * scale, torque
    )
    np.testing.assert_allclose(other, seconds, rtol=1e-9, atol=1e-9 * np.abs(seconds).max())


@settings(deadline=None)
@given(logs, logs, logs)
def test_creep_under_a_step_only_grows(k_v, c_v, c_p):
    angle = compute_joint_angle_array(*np.exp([k_v, c_v, c_p]), 0.0, TIME, [0.0], [1.0])
    assert (np.diff(angle) >= 0.0).all()
    assert (angle[TIME <= 0.0] == 0.0).all()
