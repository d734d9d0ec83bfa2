import numpy as np

from softfinger.mechanics.wires import compute_moment_arm_array, moment_arm_slope


def test_arm_is_the_derivative_of_the_papers_wire_length():
    angle = np.random.default_rng(2).normal(size=15)
    reach, tilt = np.hypot(0.004, 0.005), np.arctan(2 * 0.005 / 0.008)
    for sign in (1, -1):
        ahead, behind = (
            0.008 - 2 * reach * np.cos((angle + step) / 2 + sign * tilt) for step in (1e-5, -1e-5)
        )
        arm = sign * compute_moment_arm_array(sign * angle, 0.008, 0.005)
        np.testing.assert_allclose(arm, (ahead - behind) / 2e-5, atol=1e-12)


def test_arm_of_the_straight_finger_is_the_wire_offset_and_grows_by_a_sixth_at_half_a_radian():
    arm = compute_moment_arm_array([0.0, 0.5], 0.008, 0.005)
    assert arm[0] == 0.005
    np.testing.assert_allclose(arm[1] / arm[0], 1.1668, atol=1e-4)


def test_arm_slope_is_the_limit_of_differences():
    arm = compute_moment_arm_array([0.3 - 1e-5, 0.3 + 1e-5], 0.008, 0.005)
    np.testing.assert_allclose(
        moment_arm_slope(0.3, 0.004, 0.005), np.diff(arm)[0] / 2e-5, rtol=1e-9
    )
